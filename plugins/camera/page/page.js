/* The page: sends the camera's pictures to the worker, and the hands that it finds to marotte. In a
 * headset's browser it sends the hands that the headset tracks. camera_wire.h describes the messages. */
'use strict';

const at = (id) => document.getElementById(id);
const video = at('video'), canvas = at('skeleton'), startButton = at('start'), headsetButton = at('headset');
const BONES = [[0, 1, 2, 3, 4], [0, 5, 6, 7, 8], [5, 9, 10, 11, 12], [9, 13, 14, 15, 16],
               [13, 17, 18, 19, 20], [0, 17]];

/* ---- messages to the user ---- */

const troubles = new Map();
function trouble(kind, text) {
  if (text) troubles.set(kind, text);
  else troubles.delete(kind);
  at('trouble').textContent = [...troubles.values()].join('\n');
  at('trouble').hidden = troubles.size === 0;
}

function light(id, state, text) {
  at(id).dataset.state = state;
  if (text) at(id).textContent = text;
}

/* ---- marotte ---- */

let socket = null, patience = 250, wanted = 1, hasPackage = false, isOver = false;
let trip = NaN;

function connect() {
  socket = new WebSocket(new URL('socket', location.href).href.replace(/^http/, 'ws'),
                         'marotte.camera.1');
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => {
    patience = 250;
    hello();
    for (let i = 0; i < 4; ++i) setTimeout(ping, 50 * i);
  };
  socket.onmessage = ({data}) => (typeof data === 'string' ? hear(JSON.parse(data)) : answered(data));
  socket.onclose = () => {
    startButton.disabled = !running;
    headsetButton.disabled = true;
    if (isOver) return;
    light('link', 'bad', 'marotte does not answer: start it and open the input camera');
    setTimeout(connect, patience);
    patience = Math.min(2 * patience, 2000);
  };
}

function hello() {
  if (socket.readyState === WebSocket.OPEN)
    socket.send(JSON.stringify({type: 'hello', agent: navigator.userAgent.slice(0, 200)}));
}

function ping() {
  if (!socket || socket.readyState !== WebSocket.OPEN) return;
  const message = new DataView(new ArrayBuffer(9));
  message.setUint8(0, 2);
  message.setFloat64(1, performance.now(), true);
  socket.send(message);
}

function answered(bytes) {
  const message = new DataView(bytes);
  if (message.byteLength === 17 && message.getUint8(0) === 3)
    trip = performance.now() - message.getFloat64(1, true);
}

function hear(message) {
  if (message.type === 'bye') {
    isOver = true;
    light('link', 'waits', 'another page is in use: close this page, or reload it to use it');
    stop();
    if (session) session.end();
    startButton.disabled = headsetButton.disabled = true;
    return;
  }
  if (message.type !== 'state') return;
  hasPackage = message.package;
  light('link', 'good', 'marotte is listening');
  trouble('package', hasPackage ? '' :
    'The hand tracker is not installed. Press "Camera" on the stage of marotte: it downloads the tracker.\n' +
    'This page continues when it is installed.');
  startButton.disabled = !hasPackage || inHeadset;
  headsetButton.disabled = inHeadset;
  const hands = Math.min(Math.max(message.hands, 1), 2);
  if (hands !== wanted) {
    wanted = hands;
    if (worker) worker.postMessage(options());
  }
}

setInterval(() => {
  ping();
  if (!hasPackage && socket && !isOver) hello();
}, 1000);

/* ---- the hands ---- */

let worker = null, isReady = false, isBusy = false, running = null, sequence = 0;
const recent = [];

const options = () => ({model: Number(at('model').value), hands: wanted});

function send(captured, hands) {
  if (!socket || socket.readyState !== WebSocket.OPEN || socket.bufferedAmount > 1024) return;
  const message = new DataView(new ArrayBuffer(14 + 425 * hands.length));
  message.setUint8(0, 1);
  message.setUint32(1, sequence++, true);
  message.setFloat64(5, captured, true);
  message.setUint8(13, hands.length);
  hands.forEach((hand, i) => {
    let offset = 14 + 425 * i;
    message.setUint8(offset, hand.side);
    message.setFloat32(offset + 1, Math.min(Math.max(hand.score, 0), 1), true);
    offset += 5;
    for (const value of hand.world) { message.setFloat32(offset, value, true); offset += 4; }
    for (const value of hand.image) { message.setFloat32(offset, value, true); offset += 4; }
  });
  socket.send(message);
}

function draw(hands) {
  const pen = canvas.getContext('2d');
  canvas.width = video.videoWidth;
  canvas.height = video.videoHeight;
  pen.lineWidth = Math.max(2, canvas.width / 200);
  for (const hand of hands) {
    pen.strokeStyle = pen.fillStyle = hand.side ? '#ffb454' : '#6cc7ff';
    const place = (n) => [hand.image[2 * n] * canvas.width, hand.image[2 * n + 1] * canvas.height];
    for (const bone of BONES) {
      pen.beginPath();
      bone.forEach((n, i) => (i ? pen.lineTo(...place(n)) : pen.moveTo(...place(n))));
      pen.stroke();
    }
    for (let n = 0; n < 21; ++n) {
      pen.beginPath();
      pen.arc(...place(n), pen.lineWidth * 1.4, 0, 7);
      pen.fill();
    }
  }
}

function lights(hands) {
  for (const [side, id] of [[0, 'hand-left'], [1, 'hand-right']])
    light(id, hands.some((hand) => hand.side === side) ? 'good' : 'off');
}

/* ---- the card of the hand's parts; moving parts are highlighted ---- */

/* Roughly the angles of plugin.h, rad, from the 21 points: only their change is used. */
function anglesOf(world) {
  const point = (n) => [world[3 * n], world[3 * n + 1], world[3 * n + 2]];
  const way = (a, b) => point(b).map((value, k) => value - point(a)[k]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((value) => value / (Math.sqrt(dot(a, a)) || 1));
  const between = (a, b) => Math.acos(Math.min(Math.max(dot(unit(a), unit(b)), -1), 1));
  const angle = new Array(22).fill(0);
  const palm = unit(cross(way(0, 5), way(0, 17))), thumb = unit(way(1, 2));
  angle[0] = Math.asin(dot(thumb, palm));
  angle[1] = between(way(1, 2), way(2, 3));
  angle[2] = between(way(2, 3), way(3, 4));
  angle[3] = between(way(1, 2), way(0, 5));
  [[4, 5], [7, 9], [11, 13], [15, 17]].forEach(([at, knuckle]) => {
    const towards = Math.sign(dot(unit(way(knuckle, knuckle + 1)), palm)) || 1;
    angle[at] = towards * between(way(0, knuckle), way(knuckle, knuckle + 1));
    angle[at + 1] = between(way(knuckle, knuckle + 1), way(knuckle + 1, knuckle + 2));
  });
  angle[10] = between(way(5, 6), way(9, 10));
  angle[14] = between(way(9, 10), way(13, 14));
  angle[18] = between(way(13, 14), way(17, 18));
  const along = unit(way(0, 9));
  angle[20] = Math.asin(along[1]);
  angle[21] = Math.atan2(along[0], along[2] || 1e-6);
  return angle;
}

const seen = []; // of the last quarter of a second
const items = typeof CARD === 'undefined' ? [] : CARD.map((line) => {
  const item = document.createElement('li'), name = document.createElement('b');
  name.textContent = line.hand;
  item.append(name, ` ${line.face}`);
  at('card').append(item);
  return item;
});

function lightCard(hand) {
  const now = performance.now();
  if (!hand) seen.length = 0;
  else seen.push({now, angle: anglesOf(hand.world)});
  while (seen.length && seen[0].now < now - 250) seen.shift();
  const strength = items.map((_, i) => !seen.length ? 0 :
    Math.abs(CARD[i].perRad.reduce((sum, by, k) =>
      sum + by * (seen[seen.length - 1].angle[k] - seen[0].angle[k]), 0)));
  const most = Math.max(0.3, ...strength);
  items.forEach((item, i) => item.classList.toggle('lit', strength[i] > 0.7 * most));
}

function show(hands, captured) {
  const now = performance.now();
  recent.push({now, late: now - captured});
  while (recent[0].now < now - 2000) recent.shift();
  const lates = recent.map((one) => one.late).sort((a, b) => a - b);
  at('figures').textContent = `${(recent.length / 2).toFixed(0)} pictures per second, ` +
    `${lates[lates.length >> 1].toFixed(0)} ms from picture to hand` +
    (trip >= 0 ? `, ${trip.toFixed(0)} ms to marotte and back` : '');
  lights(hands);
  lightCard(hands.find((hand) => hand.side === 1) || hands[0]);
  draw(hands);
}

function found({data}) {
  if (data.ready) {
    isReady = true;
    trouble('start', '');
  } else if (data.failed) {
    isBusy = false;
    trouble('start', data.failed === 'webgl' ?
      'This browser has no WebGL, which the hand detector needs: switch on hardware ' +
      'acceleration in its settings, or try another browser.' :
      `The hand detector failed: ${data.failed}`);
    if (!isReady) stop();
  } else {
    isBusy = false;
    if (!running) return;
    send(data.captured, data.hands);
    show(data.hands, data.captured);
  }
}

async function picture(captured) {
  if (!isReady || isBusy) return;
  isBusy = true;
  try {
    const bitmap = await createImageBitmap(video);
    worker.postMessage({bitmap, captured}, [bitmap]);
  } catch (error) {
    isBusy = false;
  }
}

function follow(stream) {
  const next = (now, about) => {
    if (running !== stream) return;
    picture(about && about.captureTime ? about.captureTime : now);
    video.requestVideoFrameCallback ? video.requestVideoFrameCallback(next) : requestAnimationFrame(next);
  };
  video.requestVideoFrameCallback ? video.requestVideoFrameCallback(next) : requestAnimationFrame(next);
}

/* ---- the camera ---- */

function stop() {
  if (running) running.getTracks().forEach((track) => track.stop());
  running = null;
  startButton.hidden = false;
}

async function list() {
  const chosen = at('camera').value;
  const found = (await navigator.mediaDevices.enumerateDevices()).filter((d) => d.kind === 'videoinput');
  at('camera').replaceChildren(new Option('Default', ''),
    ...found.map((d, i) => new Option(d.label || `camera ${i + 1}`, d.deviceId)));
  at('camera').value = found.some((d) => d.deviceId === chosen) ? chosen : '';
}

async function start() {
  stop();
  trouble('camera', '');
  const device = at('camera').value;
  try {
    const stream = await navigator.mediaDevices.getUserMedia({
      video: {width: 640, height: 480, frameRate: {ideal: 60}, ...(device && {deviceId: {exact: device}})},
    });
    stream.getVideoTracks()[0].onended = () => {
      trouble('camera', 'The camera was unplugged, or another program uses it.');
      stop();
    };
    running = stream;
    video.srcObject = stream;
    await video.play();
    startButton.hidden = true;
    list();
    if (!worker) {
      worker = new Worker('worker.js');
      worker.onmessage = found;
      worker.onerror = (event) => found({data: {failed: event.message || 'cannot load the worker'}});
      trouble('start', 'Loading the hand detector…');
      worker.postMessage({start: options()});
    }
    follow(stream);
  } catch (error) {
    stop();
    trouble('camera', error.name === 'NotAllowedError' ?
      'The browser has no permission to use the camera: allow it next to the address bar, and start again.' :
      error.name === 'NotFoundError' ? 'No camera found: plug one in, and start again.' :
      `Cannot open the camera (${error.name}): does another program use it?`);
  }
}

/* ---- a headset ---- */

/* MediaPipe's 21 landmarks in their order, with WebXR's names; without the metacarpals of the four
 * fingers. The position of a joint is the beginning of its bone. */
const FINGER = ['phalanx-proximal', 'phalanx-intermediate', 'phalanx-distal', 'tip'];
const JOINTS = ['wrist',
  ...['metacarpal', 'phalanx-proximal', 'phalanx-distal', 'tip'].map((joint) => `thumb-${joint}`),
  ...['index', 'middle', 'ring', 'pinky'].flatMap(
    (finger) => FINGER.map((joint) => `${finger}-finger-${joint}`))];
const FRAME_MS = 1000 / 90, NO_IMAGE = new Float32Array(42);
let session = null, inHeadset = false; // inHeadset: true after the click

/* Positions relative to the wrist, so that no position in the room is out of range. WebXR's y is up and
 * its z towards the viewer: half a turn about z gives the axes of the camera's landmarks. null: not tracked. */
function headsetHand(source, frame, space) {
  const matrices = new Float32Array(16 * JOINTS.length);
  if (!source.hand || !/^(left|right)$/.test(source.handedness)) return null;
  if (!frame.fillPoses(JOINTS.map((name) => source.hand.get(name)), space, matrices)) return null;
  const place = (n, k) => matrices[16 * n + 12 + k] - matrices[12 + k];
  const world = JOINTS.flatMap((_, n) => [-place(n, 0), -place(n, 1), place(n, 2)]);
  return world.every(Number.isFinite) ?
    {side: source.handedness === 'right' ? 1 : 0, score: 1, world, image: NO_IMAGE} : null;
}

function watch(own, space, layer, gl) {
  let dueMs = 0;
  const next = (timeMs, frame) => {
    if (session !== own) return;
    own.requestAnimationFrame(next);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (timeMs < dueMs - 1) return; // 1 ms: tolerance for uneven frames
    dueMs = Math.max(dueMs + FRAME_MS, timeMs);
    const hands = [...own.inputSources].map((source) => headsetHand(source, frame, space)).filter(Boolean);
    send(timeMs, hands);
    lights(hands);
  };
  own.requestAnimationFrame(next);
}

function leaveHeadset() {
  session = null;
  inHeadset = false;
  lights([]);
  startButton.disabled = !hasPackage || isOver;
  headsetButton.disabled = isOver;
}

async function enterHeadset(mode) {
  stop();
  trouble('headset', '');
  inHeadset = true;
  startButton.disabled = headsetButton.disabled = true;
  let own = null;
  try {
    own = await navigator.xr.requestSession(mode, {requiredFeatures: ['hand-tracking']});
    own.onend = leaveHeadset;
    session = own;
    const gl = document.createElement('canvas').getContext('webgl', {xrCompatible: true});
    gl.clearColor(0, 0, 0, mode === 'immersive-ar' ? 0 : 1); // AR shows the room
    const layer = new XRWebGLLayer(own, gl);
    await own.updateRenderState({baseLayer: layer});
    watch(own, await own.requestReferenceSpace('local'), layer, gl);
  } catch (error) {
    trouble('headset', error.name === 'NotSupportedError' ?
      'This headset provides no hand tracking to browsers: switch it on in its settings, and put the controllers down.' :
      `Cannot get the headset's hands (${error.name}): allow this page to use them, and try again.`);
    own ? own.end().catch(leaveHeadset) : leaveHeadset();
  }
}

/* Uses AR if the headset supports it, so that the performer sees the room and the face. */
async function offerHeadset() {
  for (const mode of navigator.xr ? ['immersive-ar', 'immersive-vr'] : []) {
    if (!await navigator.xr.isSessionSupported(mode).catch(() => false)) continue;
    headsetButton.onclick = () => enterHeadset(mode);
    headsetButton.hidden = at('headset-help').hidden = false;
    return;
  }
}

startButton.onclick = start;
at('camera').onchange = () => running && start();
at('model').onchange = () => {
  localStorage.setItem('model', at('model').value);
  if (worker) worker.postMessage(options());
};
at('model').value = localStorage.getItem('model') || '1';
document.onvisibilitychange = () => trouble('hidden', document.hidden ?
  'This tab is hidden, so the browser slows it down. Keep it visible, in a separate window.' : '');

if (!window.Worker || !window.OffscreenCanvas || !navigator.mediaDevices)
  trouble('browser', 'This browser is too old: use a Chromium, Firefox or Safari of the last three years.');
at('reverse').textContent = `adb reverse tcp:${location.port} tcp:${location.port}`;
offerHeadset();
connect();
