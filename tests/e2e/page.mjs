// A page of a test's own in a headless Chromium with a software renderer, that reaches nothing but what the test serves: for
// three_play.mjs and vrm_listen.mjs.
import {spawn} from 'node:child_process';
import {createServer} from 'node:http';
import {readFileSync} from 'node:fs';
import {extname} from 'node:path';

const imports = `<script type="importmap">{"imports": {
  "three": "/packages/three/build/three.module.js", "three/addons/": "/packages/three/examples/jsm/",
  "@pixiv/three-vrm": "/packages/@pixiv/three-vrm/lib/three-vrm.module.js",
  "@pixiv/three-vrm-animation": "/packages/@pixiv/three-vrm-animation/lib/three-vrm-animation.module.js"}}</script>`;
const types = {'.js': 'text/javascript', '.html': 'text/html'};

// program: the browser; folder: its own; packages: node_modules; files: paths or bytes, by where the page finds them. The module
// script says when it is ready by window.ready. Returns value(), what an expression is there, and end(), with an exit code.
export async function openPage({program, folder, packages, files, script}) {
  const page = `<!doctype html>${imports}<script type="module">${script}</script>`;
  const server = createServer((request, response) => {
    const file = request.url.startsWith('/packages/') && !request.url.includes('..')
        ? packages + request.url.slice('/packages'.length) : files[request.url];
    if (request.url === '/') return response.setHeader('content-type', 'text/html').end(page);
    try {
      response.setHeader('content-type', types[extname(request.url)] ?? 'application/octet-stream')
          .end(typeof file === 'string' ? readFileSync(file) : file);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));

  const browser = spawn(program, [
    '--headless=new', '--no-sandbox', '--remote-debugging-pipe', `--user-data-dir=${folder}`, '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--no-first-run', '--disable-background-networking',
    '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1', 'about:blank',
  ], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
  let next = 0, rest = '', session;
  const waiting = new Map();
  browser.stdio[4].on('data', (bytes) => {
    rest += bytes;
    for (let end; (end = rest.indexOf('\0')) >= 0; rest = rest.slice(end + 1)) {
      const message = JSON.parse(rest.slice(0, end));
      if (waiting.has(message.id)) waiting.get(message.id)(message.result ?? {});
      if (message.method === 'Runtime.exceptionThrown') console.error('exception:', JSON.stringify(message.params).slice(0, 600));
    }
  });
  const call = (method, params = {}) => new Promise((resolve) => {
    waiting.set(++next, resolve);
    browser.stdio[3].write(JSON.stringify({id: next, method, params, sessionId: session}) + '\0');
  });
  const value = async (expression) =>
    (await call('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true})).result?.value;
  const end = (code) => {
    browser.kill('SIGKILL');
    process.exit(code);
  };
  const {targetId} = await call('Target.createTarget', {url: `http://127.0.0.1:${server.address().port}/`});
  session = (await call('Target.attachToTarget', {targetId, flatten: true})).sessionId;
  await call('Runtime.enable');
  for (let i = 0; i < 600 && await value('window.ready') !== true; ++i)
    await new Promise((resolve) => setTimeout(resolve, 100));
  return {value, end};
}
