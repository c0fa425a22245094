// node usda.mjs FILE.usda FILE.pc2 MM: reads FILE by the grammar of OpenUSD's text format (a recursive descent of our
// own, which knows nothing of what wrote it), checks what UsdSkel and UsdGeom ask of it, and says how far what it
// shows is off the point cache, whose unit is MM mm, at ten times.
import fs from 'node:fs'

const [file, cache, cacheMm] = process.argv.slice(2)
const text = fs.readFileSync(file, 'utf8')
const fail = (what) => {
  console.log(`${file}: ${what}`)
  process.exit(1)
}

// ---- the grammar: https://openusd.org, "USDA", as pxr/usd/sdf/textFileFormat.yy has it ----
let at = 0
const where = () => `line ${text.slice(0, at).split('\n').length}`
const skip = () => {
  const blank = /(?:[\s;]|#(?!usda)[^\n]*)*/y
  blank.lastIndex = at
  blank.exec(text)
  at = blank.lastIndex
}
const take = (pattern) => {
  skip()
  pattern.lastIndex = at
  const found = pattern.exec(text)
  if (found) at = pattern.lastIndex
  return found
}
const need = (pattern, what) => take(pattern) ?? fail(`${where()}: ${what} is missing: "${text.slice(at, at + 40)}"`)
const identifier = /[A-Za-z_][A-Za-z0-9_]*/y
const property = /[A-Za-z_][A-Za-z0-9_]*(?::[A-Za-z_][A-Za-z0-9_]*)*/y
const string = () => {
  const found = need(/"((?:[^"\\\n]|\\.)*)"/y, 'a string')
  return found[1].replace(/\\(.)/g, '$1')
}
const list = (open, close, item) => {
  const out = []
  need(open, String(open))
  while (!take(close)) {
    out.push(item())
    if (!take(/,/y)) {
      need(close, String(close))
      break
    }
  }
  return out
}
const value = () => {
  skip()
  const next = text[at]
  if (next === '[') return list(/\[/y, /\]/y, value)
  if (next === '(') return list(/\(/y, /\)/y, value)
  if (next === '"') return string()
  if (next === '<') return { path: need(/<([^>]*)>/y, 'a path')[1] }
  return Number(need(/[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/y, 'a number')[0])
}
const dictionary = () => {
  const out = {}
  need(/\{/y, '{')
  while (!take(/\}/y)) {
    need(/[A-Za-z0-9_]+(?:\[\])?/y, 'a type')
    const name = need(property, 'a key')[0]
    need(/=/y, '=')
    out[name] = value()
  }
  return out
}
const metadata = () => {
  const out = {}
  if (!take(/\(/y)) return out
  while (!take(/\)/y)) {
    skip()
    if (text[at] === '"') {
      out.comment = string()
      continue
    }
    take(/(?:prepend|append|add|delete|reorder)\b/y)
    const name = need(identifier, 'a field of metadata')[0]
    need(/=/y, '=')
    skip()
    out[name] = text[at] === '{' ? dictionary() : value()
  }
  return out
}
const widths = { int: 1, float: 1, token: 1, string: 1, point3f: 3, normal3f: 3, vector3f: 3, float3: 3, half3: 3,
  color3f: 3, color4f: 4, texCoord2f: 2, quatf: 4, matrix4d: 4 }
const typed = (type, isArray, v) => {
  const width = widths[type] ?? fail(`${where()}: no type ${type}`)
  for (const one of isArray ? v : [v]) {
    if (width > 1 && (!Array.isArray(one) || one.length !== width)) fail(`${where()}: no ${type}: ${one}`)
    if (width === 1 && typeof one !== (['token', 'string'].includes(type) ? 'string' : 'number'))
      fail(`${where()}: no ${type}: ${one}`)
    if (type === 'int' && !Number.isInteger(one)) fail(`${where()}: no int: ${one}`)
  }
  return v
}
const prims = {}
const prim = (parent) => {
  const type = need(identifier, 'a type')[0]
  const name = need(/"([A-Za-z_][A-Za-z0-9_]*)"/y, 'a name that is an identifier')[1]
  const path = `${parent}/${name}`
  if (prims[path]) fail(`${path} is there twice`)
  const self = { type, path, meta: metadata(), at: {}, samples: {}, rel: {}, children: [] }
  prims[path] = self
  need(/\{/y, '{')
  while (!take(/\}/y)) {
    if (take(/def\b/y)) {
      self.children.push(prim(path))
      continue
    }
    if (take(/rel\b/y)) {
      const target = need(property, 'a relationship')[0]
      need(/=/y, '=')
      self.rel[target] = [value()].flat().map((v) => v.path)
      continue
    }
    take(/(?:uniform|varying|custom)\b/y)
    const kind = need(identifier, 'a type')[0]
    const isArray = take(/\[\]/y) !== null
    const called = need(property, 'a property')[0]
    if (take(/\.connect\b/y)) {
      need(/=/y, '=')
      self.rel[called] = [value().path]
    } else if (take(/\.timeSamples\b/y)) {
      need(/=/y, '=')
      self.samples[called] = new Map(list(/\{/y, /\}/y, () => {
        const time = value()
        need(/:/y, ':')
        return [time, typed(kind, isArray, value())]
      }))
    } else {
      if (take(/=/y)) self.at[called] = typed(kind, isArray, value())
      self[`(${called})`] = metadata()
    }
  }
  return self
}
need(/#usda 1\.0/y, 'the header')
const layer = metadata()
const roots = []
while (take(/def\b/y)) roots.push(prim(''))
skip()
if (at !== text.length) fail(`${where()}: more than prims: "${text.slice(at, at + 40)}"`)

// ---- what must be so ----
const is = (what, truth) => truth || fail(`not so: ${what}`)
const pc2 = fs.readFileSync(cache)
is('the cache is one', pc2.toString('latin1', 0, 11) === 'POINTCACHE2')
const vertices = pc2.readInt32LE(16)
const frames = pc2.readInt32LE(28)
const cached = (frame, i) => Number(cacheMm) * pc2.readFloatLE(32 + (frame * vertices * 3 + i) * 4)
for (const [path, one] of Object.entries(prims))
  for (const target of Object.values(one.rel).flat())
    is(`${path} points to ${target}, which is there`, prims[target.replace(/\..*/, '')])
is('defaultPrim is there', roots.some((r) => r.path === `/${layer.defaultPrim}`))
is('up is y', layer.upAxis === 'Y')
is('frames are counted from 0', layer.startTimeCode === 0 && layer.endTimeCode === frames - 1)
is('frames a second', layer.timeCodesPerSecond > 0 && layer.framesPerSecond === layer.timeCodesPerSecond)
const mm = layer.metersPerUnit * 1000
const meshes = Object.values(prims).filter((p) => p.type === 'Mesh')
is('one mesh', meshes.length === 1)
const mesh = meshes[0]
const points = mesh.at.points
is('as many points as vertices', points.length === vertices)
is('triangles', mesh.at.faceVertexCounts.every((n) => n === 3) &&
  mesh.at.faceVertexIndices.length === 3 * mesh.at.faceVertexCounts.length &&
  mesh.at.faceVertexIndices.every((i) => i >= 0 && i < vertices))
is('no subdivision', mesh.at.subdivisionScheme === 'none')
for (const name of ['normals', 'primvars:st', 'primvars:color'])
  if (mesh.at[name]) is(name, mesh.at[name].length === vertices && mesh[`(${name})`].interpolation === 'vertex')
const subsets = mesh.children.filter((c) => c.type === 'GeomSubset')
const covered = subsets.flatMap((s) => s.at.indices).sort((a, b) => a - b)
is('parts cover all triangles once', covered.every((t, i) => t === i) &&
  covered.length === mesh.at.faceVertexCounts.length)
for (const s of subsets) is('a part is made of something', prims[s.rel['material:binding'][0]].type === 'Material')

let shown
const shapes = mesh.children.filter((c) => c.type === 'BlendShape')
if (mesh.samples.points) {
  is('a sample for each frame', mesh.samples.points.size === frames)
  shown = (frame) => mesh.samples.points.get(frame).flat()
} else {
  const root = roots[0]
  is('a SkelRoot above all', root.type === 'SkelRoot')
  const skeleton = prims[mesh.rel['skel:skeleton'][0]]
  is('a Skeleton', skeleton.type === 'Skeleton')
  is('a joint with its transforms', skeleton.at.joints.length === skeleton.at.bindTransforms.length &&
    skeleton.at.joints.length === skeleton.at.restTransforms.length)
  for (const p of [mesh, skeleton]) is('SkelBindingAPI', p.meta.apiSchemas.includes('SkelBindingAPI'))
  const animation = prims[skeleton.rel['skel:animationSource'][0]]
  is('a SkelAnimation of those joints', animation.type === 'SkelAnimation' &&
    String(animation.at.joints) === String(skeleton.at.joints))
  is('w comes first', String(animation.at.rotations) === '1,0,0,0')
  for (const name of ['jointIndices', 'jointWeights'])
    is(name, mesh.at[`primvars:skel:${name}`].length === vertices && mesh[`(primvars:skel:${name})`].elementSize === 1)
  const names = mesh.at['skel:blendShapes'] ?? []
  const targets = mesh.rel['skel:blendShapeTargets'] ?? []
  is('a name for each target', names.length === targets.length && names.length === shapes.length &&
    new Set(names).size === names.length)
  for (const s of shapes) {
    const index = s.at.pointIndices
    is(`${s.path}: lists what it moves`, index.length === s.at.offsets.length &&
      (!s.at.normalOffsets || s.at.normalOffsets.length === index.length) &&
      index.every((v, i) => v >= 0 && v < vertices && (i === 0 || v > index[i - 1])))
  }
  const weights = animation.samples.blendShapeWeights
  is('weights for each frame', weights.size === frames)
  const order = names.map((n) => animation.at.blendShapes.indexOf(n))
  is('each shape is animated', order.every((i) => i >= 0))
  shown = (frame) => {
    const out = points.flat()
    const weight = weights.get(frame)
    is('a weight for each shape', weight.length === animation.at.blendShapes.length)
    is('weights within 0..1', weight.every((w) => w >= 0 && w <= 1))
    targets.forEach((path, t) => {
      const w = weight[order[t]]
      if (w !== 0)
        prims[path].at.pointIndices.forEach((v, i) => {
          for (let k = 0; k < 3; ++k) out[3 * v + k] += w * prims[path].at.offsets[i][k]
        })
    })
    return out
  }
}
let worst = 0, furthest = 0
const rest = points.flat()
for (let n = 0; n < 10; ++n) {
  const frame = Math.floor((frames - 1) * n / 9)
  const now = shown(frame)
  for (let v = 0; v < vertices; ++v) {
    let off = 0, moved = 0
    for (let k = 3 * v; k < 3 * v + 3; ++k) {
      off += (now[k] * mm - cached(frame, k)) ** 2
      moved += (rest[k] * mm - cached(frame, k)) ** 2
    }
    worst = Math.max(worst, off)
    furthest = Math.max(furthest, moved)
  }
}
const named = [...subsets, ...shapes].filter((p) => p.meta.displayName !== undefined)
console.log(`read: ${vertices} points, ${shapes.length} shapes, ${subsets.length} parts, ${frames} frames of ` +
  `${layer.timeCodesPerSecond} a second, ${layer.metersPerUnit} m`)
for (const p of named) console.log(`called: ${p.path} is ${p.meta.displayName}`)
console.log(`off by ${Math.sqrt(worst).toFixed(4)} mm at most; the face moves by up to ${Math.sqrt(furthest).toFixed(2)} mm`)
