// node usd_library.mjs FILE.usda ...: opens each file with TinyUSDZ, a USD library that is not ours. Exit 77: it is not
// installed (tests/e2e/setup_packages.sh).
import fs from 'node:fs'
import os from 'node:os'
import path from 'node:path'
import {pathToFileURL} from 'node:url'

const files = process.argv.slice(2)
const home = new URL('./node_modules/tinyusdz/', import.meta.url)
if (!fs.existsSync(new URL('tinyusdz.wasm', home))) {
  console.log('SKIPPED: TinyUSDZ is not installed (bash tests/e2e/setup_packages.sh)')
  process.exit(77)
}
const wasm = fs.readFileSync(new URL('tinyusdz.wasm', home))
const real = globalThis.process
// Its file is a module, but its name and its package.json do not say so: Node before 20.19 reads it as CommonJS.
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'tinyusdz-'))
fs.copyFileSync(new URL('tinyusdz.js', home), path.join(folder, 'tinyusdz.mjs'))
globalThis.window = globalThis // it was built for pages, and looks where it is
globalThis.process = undefined
const { default: load } = await import(pathToFileURL(path.join(folder, 'tinyusdz.mjs')))
const library = await load({
  instantiateWasm(imports, done) {
    WebAssembly.instantiate(wasm, imports).then((made) => done(made.instance, made.module))
    return {}
  },
})
globalThis.process = real
fs.rmSync(folder, {recursive: true})
let failed = 0
for (const file of files) {
  const stage = new library.TinyUSDZLoaderNative()
  const opened = stage.loadFromBinary(fs.readFileSync(file), file)
  const said = stage.error().trim()
  if (!opened || said || stage.numMeshes() !== 1) {
    console.log(`${file}: TinyUSDZ refuses it: ${said || `${stage.numMeshes()} meshes`}`)
    failed = 1
    continue
  }
  const mesh = stage.getMesh(0)
  console.log(`${file}: TinyUSDZ opens it: ${mesh.points.length / 3} points, ${mesh.faceVertexIndices.length / 3} triangles`)
}
process.exit(failed)
