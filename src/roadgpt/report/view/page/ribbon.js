// The road's surface: bands between two offsets, swept along the road.

const PINCH = 0.95; // share of the radius; an offset line nearer to the centre of its bend would fold
const THICK = 0.3; // m of asphalt
const APRON = 4; // m of shoulder beyond each end of the road
const ASPHALT = 0x44474d, SIDE = 0x33353a, GRAVEL = 0x8d8672, BANK = 0x7b8a5f, PAINT = 0xf4f4ef, AGAINST = 0x4a4d53;
const GREEN = 0x7f9a63; // of medians and islands

// Gathers triangles of one look; colours are per vertex.
class Shape3 {
  constructor(origin) {
    this.origin = origin;
    this.points = [];
    this.colours = [];
    this.corners = [];
  }

  get count() { return this.points.length / 3; }

  point(x, y, z, colour) {
    this.points.push(x - this.origin.x, y - this.origin.y, z - this.origin.z);
    this.colours.push(colour.r, colour.g, colour.b);
    return this.count - 1;
  }

  quad(a, b, c, d) { this.corners.push(a, b, c, a, c, d); }

  geometry() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(this.points, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(this.colours, 3));
    // seen from above, in metres: what carries grain repeats it there
    const seen = this.points.filter((_, at) => at % 3 < 2);
    geometry.setAttribute("uv", new THREE.Float32BufferAttribute(seen, 2));
    geometry.setIndex(this.corners);
    geometry.computeVertexNormals();
    return geometry;
  }

  mesh(kind = THREE.MeshLambertMaterial, look = {}) {
    return new THREE.Mesh(this.geometry(), new kind({ vertexColors: true, side: THREE.DoubleSide, ...look }));
  }
}

const colourOf = (hex) => new THREE.Color(hex);

// Stations from a to b: both, and all of the road's in between.
function stationsBetween(road, a, b) {
  return [a, ...road.s.filter((s) => s > a + 1e-6 && s < b - 1e-6), b];
}

// An offset from the centre line is one number for the whole road, or one for each of its stations.
const offsetAt = (road, t, s) => (typeof t === "number" ? t : read(t, placeIn(road.s, s)));
const movedBy = (t, metres) => (typeof t === "number" ? t + metres : t.map((each) => each + metres));
const between = (t0, t1, share) => {
  if (typeof t0 === "number" && typeof t1 === "number") return mix(t0, t1, share);
  const at = (t, i) => (typeof t === "number" ? t : t[i]);
  return (typeof t0 === "number" ? t1 : t0).map((_, i) => mix(at(t0, i), at(t1, i), share));
};

function beside(road, s, t) {
  const bend = read(road.curvature, placeIn(road.s, s));
  const { x, y, z } = onRoad(road, s, bend * t > PINCH ? PINCH / bend : t);
  return [x, y, z];
}

// A band from offset and height (t0, h0) to (t1, h1), along these stations. t0 lies left of t1: the band faces up.
function band(shape, road, stations, [t0, h0], [t1, h1], colour) {
  let left = -1;
  let right = -1;
  for (const s of stations) {
    const [x0, y0, z0] = beside(road, s, offsetAt(road, t0, s));
    const [x1, y1, z1] = beside(road, s, offsetAt(road, t1, s));
    const l = shape.point(x0, y0, z0 + h0, colour);
    const r = shape.point(x1, y1, z1 + h1, colour);
    if (left >= 0) shape.quad(right, r, l, left);
    left = l;
    right = r;
  }
}

function cap(shape, road, s, left, right, colour, isEnd) {
  const [x0, y0, z0] = beside(road, s, left);
  const [x1, y1, z1] = beside(road, s, right);
  const corners = [[x0, y0, z0], [x1, y1, z1], [x1, y1, z1 - THICK], [x0, y0, z0 - THICK]].map((p) => shape.point(...p, colour));
  if (isEnd) corners.reverse();
  shape.quad(...corners);
}

// Ground at an end of the road: the shoulder goes on a little, then a bank runs down into the land.
function apron(shape, road, bank, isEnd) {
  const s = isEnd ? road.length : 0;
  const rims = [offsetAt(road, road.lanes.rims.left, s), offsetAt(road, road.lanes.rims.right, s)];
  const beyond = (sign, metres) => ((sign > 0) === isEnd ? rims[0] + metres : rims[1] - metres);
  const place = placeIn(road.s, s);
  const heading = read(road.heading, place) + (isEnd ? 0 : Math.PI);
  const slope = read(road.grade, place) * (isEnd ? 1 : -1);
  const foot = bank * 1.3;
  const row = (ahead, metres, down, colour) => [1, -1].map((side) => {
    const [x, y, z] = beside(road, s, beyond(side, metres));
    return shape.point(x + ahead * Math.cos(heading), y + ahead * Math.sin(heading), z + Math.min(ahead, APRON) * slope - down, colour);
  });
  const gravel = colourOf(GRAVEL);
  const grass = colourOf(BANK);
  const strips = [[row(0, 0, 0.03, gravel), row(APRON, 0, 0.03, gravel)],
    [row(APRON, 0, 0.03, grass), row(APRON + bank * 1.3, foot, bank, grass)]];
  for (const [near, far] of strips) shape.quad(near[1], far[1], far[0], near[0]);
  // the corners between the bank at the end and those beside the road
  [0, 1].forEach((side) => {
    const sign = side ? -1 : 1;
    const at = (ahead, metres, down) => {
      const [x, y, z] = beside(road, s, beyond(sign, metres));
      return shape.point(x + ahead * Math.cos(heading), y + ahead * Math.sin(heading), z + Math.min(ahead, APRON) * slope - down, grass);
    };
    const corners = [at(0, 0, 0.03), at(APRON, 0, 0.03), at(APRON + bank * 1.3, foot, bank), at(0, foot, bank)];
    if (side) corners.reverse();
    shape.quad(...corners);
  });
}

function pavement(scene, origin, bank, grain) {
  const shape = new Shape3(origin);
  for (const road of roadsOf(scene)) sweep(shape, road, bank);
  if (scene.network) junctions(shape, scene.network, bank);
  return shape.mesh(THREE.MeshLambertMaterial, { map: grain });
}

// The surface of one road; `ends` says which of its ends are free, and both are if it says nothing.
function sweep(shape, road, bank) {
  const { bounds, against, rims, shoulder, median } = road.lanes;
  const free = road.ends || [true, true];
  const s = road.s;
  const [left, right] = [bounds[0].t, bounds[bounds.length - 1].t];
  bounds.slice(1).forEach(({ t }, lane) => {
    const colour = colourOf(lane < against ? AGAINST : ASPHALT);
    for (const [a, b, isGreen] of median && median.strip === lane ? stripsOf(road) : [[0, road.length, false]]) {
      if (b > a) band(shape, road, stationsBetween(road, a, b), [bounds[lane].t, 0], [t, 0], isGreen ? colourOf(GREEN) : colour);
    }
  });
  band(shape, road, s, [left, -THICK], [left, 0], colourOf(SIDE));
  band(shape, road, s, [right, 0], [right, -THICK], colourOf(SIDE));
  for (const end of [0, road.length].filter((_, i) => free[i])) cap(shape, road, end, offsetAt(road, left, end), offsetAt(road, right, end), colourOf(SIDE), end > 0);
  if (shoulder > 0) {
    for (const [side, rim, edge] of [[1, rims.left, left], [-1, rims.right, right]]) {
      const pair = [[rim, -0.03], [edge, -0.02]];
      const slope = [[movedBy(rim, side * bank * 1.3), -bank], [rim, -0.03]];
      if (side < 0) { pair.reverse(); slope.reverse(); }
      band(shape, road, s, ...pair, colourOf(GRAVEL));
      band(shape, road, s, ...slope, colourOf(BANK));
    }
    for (const isEnd of [false, true].filter((_, i) => free[i])) apron(shape, road, bank, isEnd);
  }
}

// The median along a road, in pieces: green, but for crosswalks at its ends.
function stripsOf({ length, lanes: { median } }) {
  return [[0, median.from, false], [median.from, median.to, true], [median.to, length, false]];
}

// The outline of what is green of a road's median: x, y, x, y.
function greenOf(road) {
  const { bounds, median } = road.lanes;
  const s = stationsBetween(road, median.from, median.to);
  const line = (t) => s.map((each) => beside(road, each, offsetAt(road, t, each)).slice(0, 2));
  return [...line(bounds[median.strip].t), ...line(bounds[median.strip + 1].t).reverse()].flat();
}

function markings(scene, origin) {
  const { road } = scene;
  const { width, dash, gap } = scene.marking;
  const shape = new Shape3(origin);
  const paint = colourOf(PAINT);
  const dashes = [];
  for (let a = 0; a < road.length; a += dash + gap) dashes.push(stationsBetween(road, a, Math.min(a + dash, road.length)));
  road.lanes.bounds.forEach(({ marking, t }, i, { length }) => {
    if (marking === "none") return;
    // inside the lane at an edge of the carriageway, over the boundary elsewhere
    const left = movedBy(t, i === 0 ? 0 : i === length - 1 ? width : width / 2);
    const right = movedBy(t, i === 0 ? -width : i === length - 1 ? 0 : -width / 2);
    for (const stations of marking === "broken" ? dashes : [road.s]) band(shape, road, stations, [left, 0.015], [right, 0.015], paint);
  });
  return shape.mesh(THREE.MeshLambertMaterial, { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 });
}

// The driven line, coloured by speed, on a white one that tells it from the asphalt.
function drivenLine(scene, origin, fastest) {
  const columns = scene.drive.columns;
  const group = new THREE.Group();
  const kept = spaced(columns, 0.25);
  for (const [width, lift, isCase] of [[0.52, 0.03, true], [0.36, 0.05, false]]) {
    const shape = new Shape3(origin);
    let left = -1;
    let right = -1;
    kept.forEach((i, n) => {
      const before = kept[Math.max(0, n - 1)];
      const after = kept[Math.min(kept.length - 1, n + 1)];
      const dx = columns.x[after] - columns.x[before];
      const dy = columns.y[after] - columns.y[before];
      const long = Math.hypot(dx, dy) || 1;
      const [ax, ay] = [(-dy / long) * width / 2, (dx / long) * width / 2];
      const z = Math.min(onRoad(scene.road, columns.s[i], columns.t[i]).z, columns.z[i]) + lift;
      const rgb = isCase ? [250, 250, 250] : speedColour(columns.speed[i] / fastest);
      const colour = new THREE.Color().setRGB(...rgb.map((v) => v / 255), THREE.SRGBColorSpace);
      const l = shape.point(columns.x[i] + ax, columns.y[i] + ay, z, colour);
      const r = shape.point(columns.x[i] - ax, columns.y[i] - ay, z, colour);
      if (left >= 0) shape.quad(right, r, l, left);
      left = l;
      right = r;
    });
    const nearer = isCase ? -3 : -4;
    group.add(shape.mesh(THREE.MeshBasicMaterial, { polygonOffset: true, polygonOffsetFactor: nearer, polygonOffsetUnits: nearer }));
  }
  return group;
}

// Indices of a path that lie at least so many metres apart; a car that stands makes no heap of points.
function spaced(columns, least) {
  const kept = [0];
  for (let i = 1; i < columns.x.length; i++) {
    const last = kept[kept.length - 1];
    if (Math.hypot(columns.x[i] - columns.x[last], columns.y[i] - columns.y[last]) >= least) kept.push(i);
  }
  return kept;
}
