// Opens the camera's page in a headless Chromium whose webcam is a file, starts it, and says every
// second what the page says.
//   node camera_browser.mjs CHROMIUM URL FAKE.mjpeg SECONDS PICTURE.png FOLDER [BUTTON SCRIPT.js]
// BUTTON is what starts it ("start"); SCRIPT.js runs in the page before the page's own.
import {spawn} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';

const [program, url, webcam, seconds, picture, folder, button = 'start', script] = process.argv.slice(2);
const browser = spawn(program, [
  '--headless=new', '--no-sandbox', '--remote-debugging-pipe', `--user-data-dir=${folder}`,
  '--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream',
  `--use-file-for-fake-video-capture=${webcam}`, '--enable-unsafe-swiftshader', '--no-first-run',
  '--disable-background-networking', '--window-size=1150,900',
  '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1', 'about:blank',
], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});

const began = performance.now();
let next = 0, rest = '', session;
const waiting = new Map();
browser.stdio[4].on('data', (bytes) => {
  rest += bytes;
  for (let end; (end = rest.indexOf('\0')) >= 0; rest = rest.slice(end + 1)) {
    const message = JSON.parse(rest.slice(0, end));
    if (waiting.has(message.id)) waiting.get(message.id)(message.result ?? {});
    if (message.method === 'Runtime.exceptionThrown')
      console.log('exception:', JSON.stringify(message.params).slice(0, 400));
    if (message.method === 'Network.requestWillBeSent' &&
        !/^(http|ws):\/\/127\.0\.0\.1:|^(data|blob|about|chrome-error):/.test(message.params.request.url))
      console.log('foreign:', message.params.request.url);
  }
});
const call = (method, params = {}) => new Promise((resolve) => {
  waiting.set(++next, resolve);
  browser.stdio[3].write(JSON.stringify({id: next, method, params, sessionId: session}) + '\0');
});
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const value = async (expression) =>
  (await call('Runtime.evaluate', {expression, userGesture: true})).result?.value;
const text = (id) => value(`document.getElementById('${id}').textContent`);

const {targetId} = await call('Target.createTarget', {url: 'about:blank'});
session = (await call('Target.attachToTarget', {targetId, flatten: true})).sessionId;
await call('Runtime.enable');
await call('Network.enable');
if (script) {
  await call('Page.enable');
  await call('Page.addScriptToEvaluateOnNewDocument', {source: readFileSync(script, 'utf8')});
}
await call('Page.navigate', {url});
for (let i = 0; i < 100 && await value(`document.getElementById('${button}').disabled`) !== false; ++i)
  await wait(100);
await value(`document.getElementById('${button}').click()`);
for (let i = 0; i < Number(seconds); ++i) {
  await wait(1000);
  console.log('page:', await text('link'), '|', await text('figures'), '|', await text('trouble'));
}
const used = async () => {
  const kept = session;
  session = undefined;
  const {processInfo = []} = await call('SystemInfo.getProcessInfo');
  session = kept;
  return processInfo.reduce((sum, one) => sum + one.cpuTime, 0);
};
console.log(`processor ${(await used()).toFixed(1)} s of the browser in ${((performance.now() - began) / 1000).toFixed(1)} s`);
const shot = await call('Page.captureScreenshot', {format: 'png'});
writeFileSync(picture, Buffer.from(shot.data, 'base64'));
session = undefined;
call('Browser.close');
browser.on('exit', () => process.exit(0));
setTimeout(() => browser.kill('SIGKILL'), 5000);
