// A VRM that three-vrm shows, in a headless Chromium, moves by the VMC datagrams that it hears; they are read by osc-min.
//   node vrm_listen.mjs CHROMIUM FOLDER PACKAGES HEAD.glb PORT_FILE NAME=PICTURE.png...
// HEAD.glb: an avatar of Ready Player Me with ARKit's shapes; it becomes a VRM 1.0 here, its presets bound to its visemes. Writes
// the port when the avatar stands. For each NAME it hears faces until none comes for two seconds, then prints what was heard and how
// the mouth's part of the picture, and the whole but for it, differ between the face with the most closed jaw and the one with the
// most open one, "NAME: " before each line. PICTURE.png has both.
import {createSocket} from 'node:dgram';
import {readFileSync, renameSync, writeFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';
import {openPage} from './page.mjs';

const [program, folder, packages, head, portFile, ...performances] = process.argv.slice(2);
const {fromBuffer} = await import(pathToFileURL(`${packages}/osc-min/dist/index.js`));

// ---- the avatar, as a VRM ----

const data = readFileSync(head), length = data.readUInt32LE(12);
const gltf = JSON.parse(data.subarray(20, 20 + length)), binary = data.subarray(20 + length);
const bones = {hips: 'Hips', spine: 'Spine', chest: 'Spine1', upperChest: 'Spine2', neck: 'Neck', head: 'Head',
               leftEye: 'LeftEye', rightEye: 'RightEye'};
for (const [side, Side] of [['left', 'Left'], ['right', 'Right']])
  for (const [bone, name] of Object.entries({Shoulder: 'Shoulder', UpperArm: 'Arm', LowerArm: 'ForeArm', Hand: 'Hand',
                                             UpperLeg: 'UpLeg', LowerLeg: 'Leg', Foot: 'Foot', Toes: 'ToeBase'}))
    bones[side + bone] = Side + name;
const node = (name) => ({node: gltf.nodes.findIndex((each) => each.name === name)});
const moves = (...names) => ({morphTargetBinds: gltf.nodes.flatMap((each, n) => names.flatMap((name) => {
  const index = each.mesh === undefined ? -1 : (gltf.meshes[each.mesh].extras?.targetNames ?? []).indexOf(name);
  return index < 0 ? [] : [{node: n, index, weight: 1}];
}))});
const shapes = gltf.meshes.find((mesh) => mesh.name === 'Wolf3D_Head').extras.targetNames;
const arkit = shapes.filter((name) => !/^viseme_|^mouth(Open|Smile)$|^eyesClosed|^eyesLook/.test(name));
gltf.extensionsUsed = [...gltf.extensionsUsed ?? [], 'VRMC_vrm'];
gltf.extensions = {...gltf.extensions, VRMC_vrm: {
  specVersion: '1.0',
  meta: {name: 'avatar', authors: ['tests'], licenseUrl: 'https://vrm.dev/licenses/1.0/'},
  humanoid: {humanBones: Object.fromEntries(Object.entries(bones).map(([bone, name]) => [bone, node(name)]))},
  expressions: {
    preset: {aa: moves('viseme_aa'), ih: moves('viseme_I'), ou: moves('viseme_U'), ee: moves('viseme_E'), oh: moves('viseme_O'),
             blink: moves('eyeBlinkLeft', 'eyeBlinkRight'), happy: moves('mouthSmile')},
    custom: Object.fromEntries(arkit.map((name) => [name[0].toUpperCase() + name.slice(1), moves(name)])),
  },
}};
const text = Buffer.from(JSON.stringify(gltf)), padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
const start = Buffer.from(data.subarray(0, 20));
start.writeUInt32LE(20 + padded.length + binary.length, 8);
start.writeUInt32LE(padded.length, 12);

// ---- the page ----

const script = `
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {VRMLoaderPlugin, VRMExpressionLoaderPlugin} from '@pixiv/three-vrm';

const SIZE = 480, DIFFERENT = 24;
const loader = new GLTFLoader();
loader.register((parser) => new VRMLoaderPlugin(parser));
const vrm = (await loader.loadAsync('/avatar')).userData.vrm, scene = new THREE.Scene();
scene.add(vrm.scene, new THREE.HemisphereLight(0xffffff, 0x666655, 3.0));
scene.background = new THREE.Color(0x30343a);
vrm.scene.traverse((thing) => { thing.frustumCulled = false; });
const skin = vrm.scene.getObjectByName('Wolf3D_Head');
const canvas = document.createElement('canvas');
const renderer = new THREE.WebGLRenderer({canvas, preserveDrawingBuffer: true});
renderer.setSize(SIZE, SIZE);
const camera = new THREE.PerspectiveCamera(20, 1, 0.01, 10), where = new THREE.Vector3();
const middle = vrm.humanoid.getRawBoneNode('head').getWorldPosition(new THREE.Vector3());
camera.position.set(middle.x, middle.y + 0.06, middle.z + 1.0);
camera.lookAt(middle.x, middle.y + 0.06, middle.z);

const expressions = new Map();
for (const each of vrm.expressionManager.expressions) expressions.set(each.expressionName.toLowerCase(), each.expressionName);
for (const [old, preset] of Object.entries(VRMExpressionLoaderPlugin.v0v1PresetNameMap))
  if (expressions.has(preset.toLowerCase())) expressions.set(old, expressions.get(preset.toLowerCase()));

// {values: {NAME: weight}, bones: {NAME: [x, y, z, w]}}, Unity's axes: x to the other side. Returns the names that the VRM has not.
const show = ({values, bones}) => {
  const unknown = [];
  for (const [name, value] of Object.entries(values)) {
    const known = expressions.get(name.toLowerCase());
    if (known) vrm.expressionManager.setValue(known, value);
    else unknown.push(name);
  }
  for (const [name, [x, y, z, w]] of Object.entries(bones))
    vrm.humanoid.getNormalizedBoneNode(name[0].toLowerCase() + name.slice(1))?.quaternion.set(x, -y, -z, w);
  vrm.update(1 / 60);
  renderer.render(scene, camera);
  return unknown;
};
const pixels = () => {
  const gl = renderer.getContext(), out = new Uint8Array(SIZE * SIZE * 4);
  gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, out);
  return out;
};
// Where the jaw's shape moves the skin, in pixels from below.
const mouth = () => {
  const box = new THREE.Box2(), index = skin.morphTargetDictionary.jawOpen;
  const delta = skin.geometry.morphAttributes.position[index], move = [];
  for (let v = 0; v < delta.count; ++v) move.push(Math.hypot(delta.getX(v), delta.getY(v), delta.getZ(v)));
  const most = Math.max(...move);
  skin.updateMatrixWorld(true);
  move.forEach((by, v) => {
    if (by < 0.3 * most) return;
    skin.getVertexPosition(v, where).applyMatrix4(skin.matrixWorld).project(camera);
    box.expandByPoint(new THREE.Vector2((where.x + 1) / 2 * SIZE, (where.y + 1) / 2 * SIZE));
  });
  return box;
};
window.show = (face) => show(face).length;
window.compare = (closed, open) => {
  const shot = {};
  const unknown = show(closed), box = mouth(), before = pixels();
  shot.closed = canvas.toDataURL('image/png');
  show(open);
  box.union(mouth());
  const after = pixels();
  shot.open = canvas.toDataURL('image/png');
  const count = {mouth: [0, 0], rest: [0, 0]};
  for (let i = 0; i < before.length; i += 4) {
    const x = i / 4 % SIZE, y = Math.floor(i / 4 / SIZE);
    const of = box.containsPoint(new THREE.Vector2(x, y)) ? count.mouth : count.rest;
    of[0] += [0, 1, 2].some((k) => Math.abs(before[i + k] - after[i + k]) > DIFFERENT);
    of[1] += 1;
  }
  return {...shot, unknown, version: vrm.meta.metaVersion, mouth: count.mouth[0] / count.mouth[1], rest: count.rest[0] / count.rest[1]};
};
window.both = async (a, b) => {
  const two = document.createElement('canvas'), on = two.getContext('2d');
  two.width = 2 * SIZE;
  two.height = SIZE;
  for (const [i, url] of [a, b].entries()) on.drawImage(await createImageBitmap(await (await fetch(url)).blob()), i * SIZE, 0);
  return two.toDataURL('image/png');
};
window.ready = true;
`;
const {value, end} = await openPage({program, folder, packages, script, files: {'/avatar': Buffer.concat([start, padded, binary])}});
if (await value('window.ready') !== true) {
  console.error('the avatar does not stand');
  end(1);
}

// ---- what is heard ----

let face = {values: {}, bones: {}}, closed, open, faces = 0, shown = 0, heardAt = 0, isShowing = false;
const openness = (of) => of.values.JawOpen ?? of.values.A ?? 0;
const say = ({address, args}) => {
  const given = args.map((arg) => arg.value);
  if (address === '/VMC/Ext/Blend/Val') face.values[given[0]] = given[1];
  else if (address === '/VMC/Ext/Bone/Pos') face.bones[given[0]] = given.slice(4, 8);
  else if (address === '/VMC/Ext/Blend/Apply') whole();
};
// The newest face is shown while it comes; a picture takes its time.
const whole = async () => {
  const now = structuredClone(face);
  faces += 1;
  if (!closed || openness(now) < openness(closed)) closed = now;
  if (!open || openness(now) > openness(open)) open = now;
  if (isShowing) return;
  isShowing = true;
  await value(`show(${JSON.stringify(now)})`);
  shown += 1;
  isShowing = false;
};
const socket = createSocket('udp4', (datagram) => {
  const packet = fromBuffer(datagram);
  heardAt = performance.now();
  (packet.elements ?? [packet]).forEach(say);
});
socket.bind(0, '127.0.0.1', () => {
  writeFileSync(`${portFile}.new`, String(socket.address().port));
  renameSync(`${portFile}.new`, portFile);
});
for (const performed of performances) {
  const [name, picture] = performed.split('=');
  [face, closed, open, faces, shown, heardAt] = [{values: {}, bones: {}}, undefined, undefined, 0, 0, 0];
  while (!heardAt || performance.now() - heardAt < 2000 || isShowing) await new Promise((resolve) => setTimeout(resolve, 100));
  if (!open) {
    console.error(`${name}: no whole face was heard`);
    end(1);
  }
  const said = await value(`compare(${JSON.stringify(closed)}, ${JSON.stringify(open)})`);
  if (!said) {
    console.error(`${name}: the page compares nothing`);
    end(1);
  }
  const both = await value(`both(${JSON.stringify(said.closed)}, ${JSON.stringify(said.open)})`);
  writeFileSync(picture, Buffer.from(both.split(',')[1], 'base64'));
  for (const line of [`a VRM ${said.version}: ${faces} faces heard, ${shown} shown live, unknown there: ${said.unknown.join(' ') || 'none'}`,
                      `names ${Object.keys(open.values).length}`, `bones ${Object.keys(open.bones).length}`,
                      `jaw_closed ${openness(closed)}`, `jaw_open ${openness(open)}`, `mouth ${(100 * said.mouth).toFixed(2)}`,
                      `rest ${(100 * said.rest).toFixed(2)}`])
    console.log(`${name}: ${line}`);
}
end(0);
