// Reads a COPC file by the npm package copc (not needed by any test) and says what does not fit.
// usage: npm install copc; node bench/peers/check_copc.mjs FILE.copc.laz   prints one JSON line, exit code 1 with faults
import { open } from 'node:fs/promises'
import { createRequire } from 'node:module'
import { join } from 'node:path'

const name = process.argv[2]
if (!name) {
  console.error('usage: node check_copc.mjs FILE.copc.laz')
  process.exit(2)
}
// Where it was installed: the folder one stands in.
const { Copc } = createRequire(join(process.cwd(), 'package.json'))('copc')
const file = await open(name)
const read = async (begin, end) => {
  const bytes = Buffer.alloc(end - begin)
  await file.read(bytes, 0, end - begin, begin)
  return new Uint8Array(bytes)
}
const copc = await Copc.create(read)
const { header, info } = copc
const nodes = {}
for (const pages = [info.rootHierarchyPage]; pages.length;) {
  const page = await Copc.loadHierarchyPage(read, pages.pop())
  Object.assign(nodes, page.nodes)
  pages.push(...Object.values(page.pages).filter(Boolean))
}
const faults = []
let points = 0
for (const [key, node] of Object.entries(nodes)) {
  if (node.pointCount === 0) continue
  const view = await Copc.loadPointDataView(read, copc, node)
  points += view.pointCount
  const [level, ...place] = key.split('-').map(Number)
  const getters = ['X', 'Y', 'Z'].map((axis) => view.getter(axis))
  for (let axis = 0; axis < 3; ++axis) {
    const size = (info.cube[axis + 3] - info.cube[axis]) / 2 ** level
    // A tenth of a step: the package rounds coordinates of its own.
    const low = info.cube[axis] + place[axis] * size - 0.1 * header.scale[axis]
    const high = low + size + 0.2 * header.scale[axis]
    for (let i = 0; i < view.pointCount; ++i) {
      const value = getters[axis](i)
      if (value >= low && value <= high) continue
      faults.push(`node ${key}: ${'xyz'[axis]} ${value} lies outside ${low} to ${high}`)
      break
    }
  }
}
if (points !== header.pointCount) faults.push(`nodes hold ${points} points, the header says ${header.pointCount}`)
console.log(JSON.stringify({ file: name, points, nodes: Object.keys(nodes).length, spacing: info.spacing, faults: faults.slice(0, 20) }))
process.exit(faults.length ? 1 : 0)
