// The road's surface: bands between two offsets, swept along the road.

const PINCH = 0.95; // share of the radius; an offset line nearer to the centre of its bend would fold
const THICK = 0.3; // m of asphalt
const ABOVE = 0.3; // m of the line that shows the road from afar
const LEAN = 0.6; // m that grain moves sideways for each metre upwards
const BARE = 0.35, GROWN = 0.9; // m beside the asphalt: gravel up to the first, grass from the second on
const WORN = [[0, 1], [0.15, 1], [0.3, 0.85], [0.5, 0.93], [0.7, 0.85], [0.85, 1], [1, 1]]; // across a lane: share of its width, light

// Gathers triangles of one look; colours are per vertex.
class Shape3 {
  constructor(origin) {
    this.origin = origin;
    this.points = [];
    this.colours = [];
    this.corners = [];
  }

  get count() { return this.points.length / 3; }

  // The colour of the point, or a function of the place that gives it.
  point(x, y, z, colour) {
    const { r, g, b } = typeof colour === "function" ? colour(x, y) : colour;
    this.points.push(x - this.origin.x, y - this.origin.y, z - this.origin.z);
    this.colours.push(r, g, b);
    return this.count - 1;
  }

  quad(a, b, c, d) { this.corners.push(a, b, c, a, c, d); }

  geometry() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(this.points, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(this.colours, 3));
    // in metres: what carries grain repeats it there; it leans, since seen from above slopes would stretch it
    const seen = inGroups(this.points, 3).flatMap(([x, y, z]) => [x + LEAN * z, y - LEAN * z]);
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

// A band from offset and height (t0, h0) to (t1, h1), along these stations, and from one colour to another.
// t0 lies left of t1: the band faces up.
function band(shape, road, stations, [t0, h0], [t1, h1], colour, other = colour) {
  let left = -1;
  let right = -1;
  for (const s of stations) {
    const [x0, y0, z0] = beside(road, s, offsetAt(road, t0, s));
    const [x1, y1, z1] = beside(road, s, offsetAt(road, t1, s));
    const l = shape.point(x0, y0, z0 + h0, colour);
    const r = shape.point(x1, y1, z1 + h1, other);
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

// Asphalt with markings' ground in one mesh, what grows beside it in another: their grain is not the same.
function pavement(scene, origin, renderer) {
  const [paved, verge] = [new Shape3(origin), new Shape3(origin)];
  for (const road of roadsOf(scene)) sweep(paved, verge, road);
  if (scene.network) junctions(paved, verge, scene.network, scene.land.isLaid);
  const group = new THREE.Group();
  group.add(paved.mesh(THREE.MeshLambertMaterial, asphaltGrain(renderer)), verge.mesh(THREE.MeshLambertMaterial, meadowGrain(renderer)));
  return group;
}

// The surface of one road; `ends` says which of its ends are free, and both are if it says nothing.
function sweep(paved, verge, road) {
  const { bounds, bays, rims, shoulder, median } = road.lanes;
  const free = road.ends || [true, true];
  const { asphalt, concrete, gravel } = COLOURS;
  const [left, right] = [bounds[0].t, bounds[bounds.length - 1].t];
  bounds.slice(1).forEach(({ t }, lane) => {
    const from = bounds[lane].t;
    if (median && median.strip === lane) {
      for (const [a, b, isGreen] of stripsOf(road)) {
        if (b > a) band(isGreen ? verge : paved, road, stationsBetween(road, a, b), [from, 0], [t, 0], isGreen ? grassAt : asphalt);
      }
      return;
    }
    WORN.slice(1).forEach(([share, light], n) => {
      const [share0, light0] = WORN[n];
      const [tone0, tone] = [light0, light].map((each) => asphalt.clone().multiplyScalar(each));
      band(paved, road, road.s, [between(from, t, share0), 0], [between(from, t, share), 0], tone0, tone);
    });
  });
  for (const [inner, outer] of bays) band(paved, road, road.s, [inner, 0], [outer, 0], asphalt);
  band(paved, road, road.s, [left, -THICK], [left, 0], concrete);
  band(paved, road, road.s, [right, 0], [right, -THICK], concrete);
  for (const end of [0, road.length].filter((_, i) => free[i])) cap(paved, road, end, offsetAt(road, left, end), offsetAt(road, right, end), concrete, end > 0);
  if (!(shoulder > 0)) return;
  const [bare, grown] = [BARE, GROWN].map((metres) => Math.min(1, metres / shoulder));
  for (const [edge, rim, side] of [[left, rims.left, 1], [right, rims.right, -1]]) {
    for (const [a, b, one, other] of [[0, bare, gravel, gravel], [bare, grown, gravel, grassAt], [grown, 1, grassAt, grassAt]]) {
      const pair = [[between(edge, rim, a), -LOWER], [between(edge, rim, b), -LOWER]];
      if (side > 0) band(verge, road, road.s, pair[1], pair[0], other, one);
      else band(verge, road, road.s, ...pair, one, other);
    }
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
  const { paint } = COLOURS;
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

// The driven line, coloured by speed, on a white one that tells it from the asphalt; where nobody drove, the middle of
// the road. `thick` times as wide, and then higher above it, it shows from afar where the road is.
function lineAlong(scene, origin, fastest, thick = 1) {
  const { road } = scene;
  const columns = scene.drive ? scene.drive.columns : { ...road, t: road.s.map(() => 0) };
  const group = new THREE.Group();
  const kept = spaced(columns, 0.25 * thick);
  for (const [width, lift, isCase] of [[0.42, 0.03, true], [0.28, 0.05, false]]) {
    const shape = new Shape3(origin);
    let left = -1;
    let right = -1;
    kept.forEach((i, n) => {
      const before = kept[Math.max(0, n - 1)];
      const after = kept[Math.min(kept.length - 1, n + 1)];
      const dx = columns.x[after] - columns.x[before];
      const dy = columns.y[after] - columns.y[before];
      const long = Math.hypot(dx, dy) || 1;
      const [ax, ay] = [(-dy / long) * thick * width / 2, (dx / long) * thick * width / 2];
      const z = Math.min(onRoad(road, columns.s[i], columns.t[i]).z, columns.z[i]) + lift + (thick > 1 ? ABOVE : 0);
      const rgb = isCase ? [250, 250, 250] : scene.drive ? speedColour(columns.speed[i] / fastest) : [60, 63, 68];
      const colour = new THREE.Color().setRGB(...rgb.map((v) => v / 255), THREE.SRGBColorSpace);
      const l = shape.point(columns.x[i] + ax, columns.y[i] + ay, z, colour);
      const r = shape.point(columns.x[i] - ax, columns.y[i] - ay, z, colour);
      if (left >= 0) shape.quad(right, r, l, left);
      left = l;
      right = r;
    });
    const nearer = isCase ? -3 : -4;
    const look = { polygonOffset: true, polygonOffsetFactor: nearer, polygonOffsetUnits: nearer, fog: thick === 1 };
    const mesh = shape.mesh(THREE.MeshBasicMaterial, look);
    mesh.renderOrder = thick > 1 ? 2 - isCase : 0;
    group.add(mesh);
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
