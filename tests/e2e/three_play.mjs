// What three.js with three-vrm shows of an exported file, in a headless Chromium with a software renderer.
//   node three_play.mjs CHROMIUM FOLDER PACKAGES FILE BARE.glb FILE.pc2 FPS PICTURE.png [FILE.vrma]
// At three times: the weights that it plays against those in the file; where its vertices are against the point cache; its
// picture against one of the cache's vertices themselves, and against one at rest. FOLDER: the browser's. PACKAGES: node_modules. A .vrma
// is played on FILE, and the turns of its head's bone are compared with those in the .vrma.
import {readFileSync, writeFileSync} from 'node:fs';
import {openPage} from './page.mjs';

const [program, folder, packages, file, bare, cache, fps, picture, vrma] = process.argv.slice(2);

const script = `
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {VRMLoaderPlugin} from '@pixiv/three-vrm';

const SIZE = 384, DIFFERENT = 24;
const load = (url) => {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  return loader.loadAsync(url);
};
const bytes = async (url) => (await fetch(url)).arrayBuffer();

async function play(fps) {
  const gltf = await load('/file'), still = await load('/bare'), buffer = await bytes('/cache');
  const head = new DataView(buffer), count = head.getInt32(16, true), frames = head.getInt32(28, true);
  const place = new Float32Array(buffer, 32);
  const scene = new THREE.Scene();
  scene.add(gltf.scene);
  const moved = [];
  gltf.scene.traverse((thing) => { if (thing.isMesh && thing.morphTargetInfluences) moved.push(thing); });

  // Which vertices of the cache are at a vertex's place at rest.
  let rest;
  still.scene.traverse((thing) => { if (thing.isMesh && !rest) rest = thing.geometry.attributes.position; });
  if (rest.count !== count) throw new Error('the cache has ' + count + ' vertices, the file ' + rest.count);
  const size = Math.max(...rest.array.map(Math.abs)), cell = 1e-5 * size;
  const near = [-1, 0, 1], at = new Map();
  for (let v = 0; v < count; ++v) {
    const key = [rest.getX(v), rest.getY(v), rest.getZ(v)].map((x) => Math.round(x / cell)).join();
    at.set(key, [...(at.get(key) ?? []), v]);
  }
  const where = new THREE.Vector3();
  const position = (mesh, v) => mesh.getVertexPosition(v, where).applyMatrix4(mesh.matrixWorld);
  const settle = () => { scene.updateMatrixWorld(true); };
  settle();
  const pairs = [];
  let turn = 1;
  for (turn of [1, -1]) { // a file that faces -z, as VRM 0, has half a turn about y
    for (const mesh of moved) {
      const found = Array.from({length: mesh.geometry.attributes.position.count}, () => []);
      for (const v of new Set(mesh.geometry.index.array)) { // primitives may share vertices that others show
        const p = position(mesh, v), m = [turn * p.x, p.y, turn * p.z].map((x) => Math.round(x / cell)), all = [];
        for (const a of near) for (const b of near) for (const c of near)
          all.push(...(at.get([m[0] + a, m[1] + b, m[2] + c].join()) ?? []));
        found[v] = all;
      }
      pairs.push({mesh, found});
    }
    if (pairs.some((pair) => pair.found.some((all) => all.length))) break;
    pairs.length = 0;
  }

  // The same surface at the cache's vertices, without targets or skin.
  const truth = new THREE.Scene(), copies = [];
  for (const {mesh, found} of pairs) {
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(mesh.geometry.index);
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(found.length * 3), 3));
    const copy = new THREE.Mesh(geometry, mesh.material);
    copy.frustumCulled = false;
    truth.add(copy);
    copies.push({copy, found});
  }
  for (const mesh of moved) mesh.frustumCulled = false;

  const canvas = document.createElement('canvas');
  const renderer = new THREE.WebGLRenderer({canvas, antialias: false, preserveDrawingBuffer: true});
  renderer.setSize(SIZE, SIZE);
  const box = new THREE.Box3().setFromBufferAttribute(rest);
  const middle = box.getCenter(new THREE.Vector3()), reach = box.getSize(new THREE.Vector3()).length();
  middle.x *= turn; middle.z *= turn;
  const camera = new THREE.PerspectiveCamera(30, 1, 0.01 * reach, 10 * reach);
  camera.position.set(middle.x + 0.5 * turn * reach, middle.y, middle.z + 1.6 * turn * reach);
  camera.lookAt(middle);
  const faces = new THREE.MeshNormalMaterial({flatShading: true, side: THREE.DoubleSide});
  const pixels = (what) => {
    what.overrideMaterial = faces;
    renderer.render(what, camera);
    const gl = renderer.getContext(), out = new Uint8Array(SIZE * SIZE * 4);
    gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, out);
    what.overrideMaterial = null;
    return out;
  };
  const hidden = []; // what nothing moves is in neither picture
  gltf.scene.traverse((thing) => { if (thing.isMesh && !moved.includes(thing)) hidden.push(thing); });
  for (const thing of hidden) thing.visible = false;
  const apart = (a, b) => {
    let different = 0, seen = 0;
    for (let i = 0; i < a.length; i += 4) {
      const is = [0, 1, 2].some((k) => a[i + k] || b[i + k]);
      seen += is;
      different += is && [0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > DIFFERENT);
    }
    return {share: different / seen, seen};
  };
  const atRest = pixels(scene);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  mixer.clipAction(gltf.animations[0]).play();
  const out = [];
  for (const part of [0.25, 0.5, 0.9]) {
    const frame = Math.round((frames - 1) * part);
    mixer.setTime(frame / fps);
    settle();
    let off = 0, furthest = 0, known = 0;
    for (const {mesh, found} of pairs)
      found.forEach((all, v) => {
        if (!all.length) return;
        const p = position(mesh, v).clone();
        known += 1;
        let best = Infinity;
        for (const i of all) {
          const k = (frame * count + i) * 3;
          best = Math.min(best, Math.hypot(turn * p.x * 1000 - place[k], p.y * 1000 - place[k + 1],
                                           turn * p.z * 1000 - place[k + 2]));
          furthest = Math.max(furthest, Math.hypot(rest.getX(i) * 1000 - place[k], rest.getY(i) * 1000 - place[k + 1],
                                                   rest.getZ(i) * 1000 - place[k + 2]));
        }
        off = Math.max(off, best);
      });
    for (const {copy, found} of copies) {
      const to = copy.geometry.attributes.position;
      found.forEach((all, v) => {
        const k = (frame * count + (all[0] ?? 0)) * 3;
        to.setXYZ(v, turn * place[k] / 1000, place[k + 1] / 1000, turn * place[k + 2] / 1000);
      });
      to.needsUpdate = true;
    }
    const shown = pixels(scene), wanted = pixels(truth);
    out.push({frame, known, off, furthest, apart: apart(shown, wanted).share, moved: apart(shown, atRest).share,
              seen: apart(shown, wanted).seen,
              weights: moved.map((mesh) => ({name: mesh.name, value: [...mesh.morphTargetInfluences]}))});
  }
  for (const thing of hidden) thing.visible = true;
  scene.add(new THREE.HemisphereLight(0xffffff, 0x666655, 2.5));
  scene.background = new THREE.Color(0x30343a);
  renderer.render(scene, camera);
  return {times: out, picture: canvas.toDataURL('image/png'), vrm: !!gltf.userData.vrm,
          names: Object.keys(moved[0].morphTargetDictionary)};
}
// What a .vrma does to the head's bone of the VRM.
async function pose(fps, frames) {
  const {VRMAnimationLoaderPlugin, createVRMAnimationClip} = await import('@pixiv/three-vrm-animation');
  const vrm = (await load('/file')).userData.vrm, loader = new GLTFLoader();
  loader.register((parser) => new VRMAnimationLoaderPlugin(parser));
  const animation = (await loader.loadAsync('/vrma')).userData.vrmAnimations[0];
  const mixer = new THREE.AnimationMixer(vrm.scene);
  mixer.clipAction(createVRMAnimationClip(animation, vrm)).play();
  const turns = frames.map((frame) => {
    mixer.setTime(frame / fps);
    vrm.update(0);
    return vrm.humanoid.getNormalizedBoneNode('head').quaternion.toArray();
  });
  return {turns, version: vrm.meta.metaVersion, expressions: [...animation.preset?.keys?.() ?? []]};
}
window.pose = (fps, frames) => pose(fps, frames).catch((error) => ({error: String(error?.stack ?? error)}));
window.play = (fps) => play(fps).catch((error) => ({error: String(error?.stack ?? error)}));
window.ready = true;
`;

const {value, end} = await openPage({program, folder, packages, script,
  files: {'/file': file, '/bare': bare, '/cache': cache, '/vrma': vrma}});
const said = await value(`window.play(${Number(fps)})`);
if (!said || said.error) {
  console.error(said?.error ?? 'the page says nothing');
  end(1);
}

// The weights as the file has them.
const open = (path) => {
  const data = readFileSync(path), length = data.readUInt32LE(12);
  const gltf = JSON.parse(data.subarray(20, 20 + length)), binary = 20 + length + 8;
  return {gltf, floats(index, width = 1) {
    const accessor = gltf.accessors[index], view = gltf.bufferViews[accessor.bufferView];
    const start = binary + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    return Array.from({length: accessor.count * width}, (_, i) => data.readFloatLE(start + 4 * i));
  }};
};
const {gltf, floats} = open(file);
const animation = gltf.animations[0], tracks = [];
for (const channel of animation.channels.filter((one) => one.target.path === 'weights')) {
  const sampler = animation.samplers[channel.sampler];
  tracks.push({key: floats(sampler.input), weight: floats(sampler.output)});
}
let apart = 0;
for (const time of said.times)
  for (const {value: played} of time.weights) {
    const offs = tracks.filter((track) => track.weight.length === track.key.length * played.length).map((track) =>
      Math.max(...played.map((weight, i) => Math.abs(weight - track.weight[time.frame * played.length + i]))));
    apart = Math.max(apart, offs.length ? Math.min(...offs) : Infinity);
  }
writeFileSync(picture, Buffer.from(said.picture.split(',')[1], 'base64'));
for (const time of said.times)
  console.log(`frame ${time.frame}: ${time.known} vertices ${time.off.toFixed(4)} mm off at most, moved ${time.furthest.toFixed(2)} mm; ` +
              `picture ${(100 * time.apart).toFixed(3)} % off of ${time.seen} pixels, ${(100 * time.moved).toFixed(3)} % from rest`);
console.log(`weights ${apart.toExponential(1)} off, ${said.names.length} targets${said.vrm ? ', a VRM' : ''}`);
console.log(`off ${Math.max(...said.times.map((time) => time.off)).toFixed(4)}`);
console.log(`known ${Math.min(...said.times.map((time) => time.known))}`);
console.log(`picture ${Math.max(...said.times.map((time) => 100 * time.apart)).toFixed(3)}`);
console.log(`moved ${Math.max(...said.times.map((time) => 100 * time.moved)).toFixed(3)}`);
console.log(`weights_off ${apart}`);
if (vrma) {
  const frames = said.times.map((time) => time.frame);
  const played = await value(`window.pose(${Number(fps)}, ${JSON.stringify(frames)})`);
  if (!played || played.error) {
    console.error(played?.error ?? 'the page says nothing of the .vrma');
    end(1);
  }
  const own = open(vrma), one = own.gltf.animations[0];
  const head = own.gltf.extensions.VRMC_vrm_animation.humanoid.humanBones.head.node;
  const channel = one.channels.find((each) => each.target.node === head && each.target.path === 'rotation');
  const turn = own.floats(one.samplers[channel.sampler].output, 4), flip = played.version === '0' ? [-1, 1, -1, 1] : [1, 1, 1, 1];
  let off = 0, most = 0;
  frames.forEach((frame, n) => {
    const wanted = turn.slice(4 * frame, 4 * frame + 4).map((x, i) => x * flip[i]);
    const along = Math.abs(wanted.reduce((sum, x, i) => sum + x * played.turns[n][i], 0));
    off = Math.max(off, 2 * Math.acos(Math.min(along, 1)) * 180 / Math.PI);
    most = Math.max(most, 2 * Math.acos(Math.min(Math.abs(wanted[3]), 1)) * 180 / Math.PI);
  });
  console.log(`vrma: the head of VRM ${played.version} turns by up to ${most.toFixed(2)} degrees, ${off.toFixed(4)} off`);
  console.log(`head_off ${off}`);
  console.log(`head_turns ${most}`);
}
end(0);
