// node usd_library.mjs FILE.usda ...: TinyUSDZ, a USD library that is not ours, opens each file. Exit 77: it is not
// installed (tests/e2e/setup_validator.sh).
import fs from 'node:fs'

const files = process.argv.slice(2)
const home = new URL('./node_modules/tinyusdz/', import.meta.url)
if (!fs.existsSync(new URL('tinyusdz.wasm', home))) {
  console.log('SKIPPED: TinyUSDZ is not installed (bash tests/e2e/setup_validator.sh)')
  process.exit(77)
}
const wasm = fs.readFileSync(new URL('tinyusdz.wasm', home))
const real = globalThis.process
globalThis.window = globalThis // it was built for pages, and looks where it is
globalThis.process = undefined
const { default: load } = await import(new URL('tinyusdz.js', home))
const library = await load({
  instantiateWasm(imports, done) {
    WebAssembly.instantiate(wasm, imports).then((made) => done(made.instance, made.module))
    return {}
  },
})
globalThis.process = real
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
