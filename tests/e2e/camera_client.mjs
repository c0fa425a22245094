// Stands for the camera's page: sends recorded landmarks, as a browser would send them.
//   node camera_client.mjs PORT TOKEN FRAMES.json FRAMES_PER_SECOND [COUNT]
import {connect} from 'node:net';
import {readFileSync} from 'node:fs';
import {randomBytes} from 'node:crypto';

const [port, token, file, rate, count] = process.argv.slice(2);
const frames = JSON.parse(readFileSync(file)).slice(0, Number(count) || undefined);
const socket = connect(Number(port), '127.0.0.1');
socket.setNoDelay(true);

function frame(opcode, payload) {
  const mask = randomBytes(4), size = payload.length;
  const head = size < 126 ? Buffer.from([0x80 | opcode, 0x80 | size])
                          : Buffer.from([0x80 | opcode, 0xfe, size >> 8, size & 255]);
  socket.write(Buffer.concat([head, mask, payload.map((byte, i) => byte ^ mask[i % 4])]));
}

function ping() {
  const message = Buffer.alloc(9);
  message.writeUInt8(2);
  message.writeDoubleLE(performance.now(), 1);
  frame(2, message);
}

function show(points, sequence) {
  const message = Buffer.alloc(14 + 425);
  message.writeUInt8(1);
  message.writeUInt32LE(sequence, 1);
  message.writeDoubleLE(performance.now(), 5);
  message.writeUInt8(1, 13);
  message.writeUInt8(1, 14); // the right hand
  message.writeFloatLE(0.95, 15);
  points.flat().forEach((value, i) => message.writeFloatLE(value, 19 + 4 * i));
  frame(2, message);
}

socket.write(`GET /${token}/socket HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n` +
  `Origin: http://127.0.0.1:${port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n` +
  `Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: ${randomBytes(16).toString('base64')}\r\n` +
  'Sec-WebSocket-Protocol: marotte.camera.1\r\n\r\n');
socket.once('data', (answer) => {
  if (!answer.toString().startsWith('HTTP/1.1 101 ')) {
    console.error(answer.toString().split('\r\n')[0]);
    process.exit(1);
  }
  for (let i = 0; i < 4; ++i) ping();
  const start = performance.now();
  let next = 0;
  const timer = setInterval(() => {
    while (next < frames.length && performance.now() - start >= 1000 * next / Number(rate)) {
      if (frames[next].length === 21) show(frames[next], next);
      next += 1;
    }
    if (next < frames.length) return;
    clearInterval(timer);
    frame(8, Buffer.from([1000 >> 8, 1000 & 255]));
    setTimeout(() => process.exit(0), 100);
  }, 4);
});
socket.on('error', (error) => { console.error(String(error)); process.exit(1); });
