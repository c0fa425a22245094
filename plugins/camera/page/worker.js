/* Finds hands in pictures with MediaPipe Hands, in a worker thread, so that inference does not block
 * the page. In:  {start: {model, hands}}, {model, hands}, {bitmap, captured}
 *        Out: {ready}, {failed: why}, {captured, hands: [{side, score, world, image}], took} */
'use strict';

/* The package needs a document. This one loads scripts synchronously and creates off-screen canvases. */
self.window = self;
self.document = {
  body: {
    appendChild(script) {
      let event = 'load';
      try {
        importScripts(script.src);
      } catch (error) {
        event = 'error';
        failed = String(error);
      }
      setTimeout(() => script.heard[event] && script.heard[event](), 0);
    },
  },
  createElement(name) {
    if (name === 'canvas') return new OffscreenCanvas(1, 1);
    return {
      heard: {},
      setAttribute(key, value) { this[key] = value; },
      addEventListener(event, listener) { this.heard[event] = listener; },
    };
  },
};
self.alert = (text) => { failed = text; };

let finder = null, failed = '', captured = 0, began = 0;

/* In a picture that is not mirrored, MediaPipe labels the right hand "Left". */
const side_of = (label) => (label === 'Left' ? 1 : 0);

function tell(results) {
  const hands = [];
  const world = results.multiHandWorldLandmarks || [], image = results.multiHandLandmarks || [];
  for (let i = 0; i < world.length && i < 2; ++i) {
    const points = new Float32Array(63), places = new Float32Array(42);
    world[i].forEach((p, n) => points.set([p.x, p.y, p.z], 3 * n));
    image[i].forEach((p, n) => places.set([p.x, p.y], 2 * n));
    const known = results.multiHandedness[i];
    hands.push({side: side_of(known.label), score: known.score, world: points, image: places});
  }
  postMessage({captured, hands, took: performance.now() - began});
}

function options(wanted) {
  return {
    selfieMode: false, maxNumHands: wanted.hands, modelComplexity: wanted.model,
    minDetectionConfidence: 0.5, minTrackingConfidence: 0.5, useCpuInference: true,
  };
}

async function start(wanted) {
  const canvas = new OffscreenCanvas(1, 1);
  if (!canvas.getContext('webgl2') && !canvas.getContext('webgl')) {
    postMessage({failed: 'webgl'});
    return;
  }
  try {
    importScripts('hands/hands.js');
    finder = new Hands({locateFile: (file) => new URL('hands/' + file, location.href).href});
    finder.setOptions(options(wanted));
    finder.onResults(tell);
    await finder.initialize();
    if (failed) throw new Error(failed);
    postMessage({ready: true});
  } catch (error) {
    finder = null;
    postMessage({failed: failed || String(error)});
  }
}

onmessage = async ({data}) => {
  if (data.start) {
    await start(data.start);
  } else if (data.bitmap) {
    captured = data.captured;
    began = performance.now();
    try {
      await finder.send({image: data.bitmap});
    } catch (error) {
      postMessage({failed: String(error)});
    }
    data.bitmap.close();
  } else if (finder) {
    finder.setOptions(options(data));
  }
};
