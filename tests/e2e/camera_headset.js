// A headset that is none, for camera_headset.sh: navigator.xr with two hands that move at 72 Hz for 5 s.
// The joints are of our own skeleton, flat: index finger of the right hand and little finger of the left
// bend at the middle joint (PIJ), 0 at first, 1 rad after 3 s. Then the right one is not tracked
// (3.2 s), the left one has a joint that is no number (3.6 s), both are back (4 s), the session ends (5 s).
'use strict';
{
  const FLAT_MM = [
    [0.0, 0.0, 0.0], [18.4, -11.0, 11.0], [25.6, -11.0, 58.5], [31.2, -11.0, 95.6], [35.3, -11.0, 122.9],
    [25.8, 0.0, 86.9], [25.8, 0.0, 126.7], [25.8, 0.0, 153.9], [25.8, 0.0, 177.2], [0.0, 0.0, 92.1],
    [0.0, 0.0, 134.6], [0.0, 0.0, 163.1], [0.0, 0.0, 190.0], [-25.6, -6.1, 92.1], [-25.6, -6.1, 128.1],
    [-25.6, -6.1, 154.1], [-25.6, -6.1, 176.7], [-45.0, -21.3, 81.7], [-45.0, -21.3, 109.3], [-45.0, -21.3, 128.7],
    [-45.0, -21.3, 150.0]];
  // WebXR's 25 joints in its order; metacarpals of the fingers, which nobody may read, lie far away.
  const NAMES = ['wrist', 'thumb-metacarpal', 'thumb-phalanx-proximal', 'thumb-phalanx-distal', 'thumb-tip'];
  for (const finger of ['index', 'middle', 'ring', 'pinky'])
    for (const joint of ['metacarpal', 'phalanx-proximal', 'phalanx-intermediate', 'phalanx-distal', 'tip'])
      NAMES.push(`${finger}-finger-${joint}`);
  const known = NAMES.filter((name) => !name.endsWith('finger-metacarpal'));

  const bent = (first, rad) => FLAT_MM.map((at, n) => {
    const middle = FLAT_MM[first + 1];
    if (n < first + 2 || n > first + 3) return at;
    const along = FLAT_MM[first + 1].map((v, k) => v - FLAT_MM[first][k]);
    const long = Math.hypot(along[0], along[2]);
    const ahead = [along[0] / long, 0, along[2] / long]; // as it lies, seen from above
    const far = (at[0] - middle[0]) * ahead[0] + (at[2] - middle[2]) * ahead[2], up = at[1] - middle[1];
    const turned = far * Math.cos(rad) + up * Math.sin(rad);
    return [middle[0] + turned * ahead[0], middle[1] + up * Math.cos(rad) - far * Math.sin(rad),
            middle[2] + turned * ahead[2]];
  });

  let beganMs = NaN;
  const angle = () => Math.min(1, Math.max(0, (performance.now() - beganMs - 1000) / 2000));
  const after = (s) => performance.now() - beganMs > 1000 * s;

  // In a room: fingers forward (-z), back of the hand up, 12 m off where a guardian began.
  const position = (side, name) => {
    const n = known.indexOf(name);
    if (n < 0) return [5, 5, 5];
    if (side === 'right' && after(3.2) && !after(4)) return null;
    if (side === 'left' && name === 'ring-finger-tip' && after(3.6) && !after(4)) return [NaN, NaN, NaN];
    const [x, y, z] = bent(side === 'right' ? 5 : 17, angle())[n];
    const away = side === 'right' ? -x : x; // the skeleton's thumb is to the left of a right hand: +x
    return [12 + (side === 'right' ? 0.2 : -0.2) + away / 1000, 1.2 + y / 1000, -3 - z / 1000];
  };

  class Session extends EventTarget {
    inputSources = ['right', 'left'].map((handedness) => ({
      handedness, hand: new Map(NAMES.map((name) => [name, {side: handedness, name}]))}))
      .concat([{handedness: 'none'}]);
    updateRenderState(state) { this.layer = state.baseLayer; return Promise.resolve(); }
    requestReferenceSpace() { return Promise.resolve({}); }
    requestAnimationFrame(callback) {
      if (Number.isNaN(beganMs)) beganMs = performance.now();
      setTimeout(() => callback(performance.now(), {fillPoses}), 1000 / 72);
    }
    end() { this.onend(); return Promise.resolve(); }
  }
  // false where a pose is missing, as the standard has it, and that pose is NaN
  const fillPoses = (spaces, base, out) => {
    const places = spaces.map((space) => position(space.side, space.name));
    places.forEach((place, n) => out.set(place || [NaN, NaN, NaN], 16 * n + 12));
    return places.every(Boolean);
  };

  window.XRWebGLLayer = class { framebuffer = null; };
  Object.defineProperty(navigator, 'xr', {value: {
    isSessionSupported: (mode) => Promise.resolve(mode === 'immersive-vr'),
    requestSession: (mode, {requiredFeatures}) => {
      if (mode !== 'immersive-vr' || !requiredFeatures.includes('hand-tracking'))
        return Promise.reject(new DOMException('', 'NotSupportedError'));
      const session = new Session();
      setTimeout(() => session.end(), 5000);
      return Promise.resolve(session);
    },
  }});
}
