// The land around the road, and the sky. Land is scenery: it follows the road and never covers it.

const MARGIN = 70; // m around the road
const CELLS = 150; // along the longer side, at most
const FAR = [400, 1500, 6000]; // m beyond the margin, so that the land reaches the horizon
const GRID = [25, 50, 100, 250, 500, 1000, 2500, 5000]; // m between the lines on the land
const HORIZON = 0xdfe9f0, ZENITH = 0x5b97cf;
const MEADOW = [0x84a067, 0x89a36b, 0x90a772];

// Heights over a net of columns and rows.
function landOf(scene) {
  const { world } = scene;
  const roads = roadsOf(scene);
  const { reach: rim, shoulder } = scene.network || scene.road.lanes;
  const all = (name) => roads.flatMap((road) => road[name]);
  const frame = [extent(all("x"), 40), extent(all("y"), 40)];
  if (scene.drive) {
    frame[0] = extent([...frame[0], ...scene.drive.columns.x]);
    frame[1] = extent([...frame[1], ...scene.drive.columns.y]);
  }
  const span = Math.max(frame[0][1] - frame[0][0], frame[1][1] - frame[1][0]) + 2 * MARGIN;
  const cell = Math.max(2.5, span / CELLS);
  const [xs, ys] = frame.map(([low, high]) => {
    const inner = [];
    for (let v = low - MARGIN; v < high + MARGIN + cell; v += cell) inner.push(v);
    const last = inner[inner.length - 1];
    return { inner, all: [...FAR.map((far) => inner[0] - far).reverse(), ...inner, ...FAR.map((far) => last + far)] };
  });
  const net = { xs, ys, cell, wide: xs.inner.length, high: ys.inner.length };
  const reach = rim + cell * 1.45;
  if (shoulder <= 0) {
    const level = Math.min(world.z_floor, extent(all("z"))[0] - 1);
    net.heights = new Float64Array(net.wide * net.high).fill(level);
    net.bank = 0;
    return net;
  }
  net.heights = relief(net, scene, reach);
  const steep = extent(all("grade")).reduce((most, grade) => Math.max(most, Math.abs(grade)), 0);
  net.bank = 0.9 + steep * reach;
  return net;
}

// Near the road a little below its lowest point in reach; from there on smooth, with gentle hills.
function relief(net, scene, reach) {
  const { xs, ys, cell, wide, high } = net;
  const heights = new Float64Array(wide * high).fill(Infinity);
  const away = new Float64Array(wide * high).fill(Infinity);
  const lower = (place, low) => {
    const [i0, i1] = [place.x - reach, place.x + reach].map((x) => Math.round((x - xs.inner[0]) / cell));
    const [j0, j1] = [place.y - reach, place.y + reach].map((y) => Math.round((y - ys.inner[0]) / cell));
    for (let j = Math.max(0, j0); j <= Math.min(high - 1, j1); j++) {
      for (let i = Math.max(0, i0); i <= Math.min(wide - 1, i1); i++) {
        const distance = Math.hypot(xs.inner[i] - place.x, ys.inner[j] - place.y);
        if (distance > reach) continue;
        const at = j * wide + i;
        heights[at] = Math.min(heights[at], low - 0.35);
        away[at] = 0;
      }
    }
  };
  const step = Math.min(cell / 2, 2);
  for (const road of roadsOf(scene)) {
    const count = Math.max(2, Math.ceil(road.length / step));
    for (let n = 0; n <= count; n++) {
      const s = (road.length * n) / count;
      const place = onRoad(road, s, 0);
      const { left, right } = road.lanes.rims;
      lower(place, Math.min(place.z, ...(road.lanes.bank ? [left, right] : []).map((t) => onRoad(road, s, offsetAt(road, t, s)).z)));
    }
  }
  for (const [x, y, z] of inGroups(scene.network ? scene.network.inside : [], 3)) lower({ x, y }, z);
  const fixed = Array.from(away, (distance) => distance === 0);
  spread(net, heights, away);
  for (let round = 0; round < 60; round++) smooth(net, heights, fixed);
  for (let at = 0; at < heights.length; at++) {
    if (fixed[at]) continue;
    const x = xs.inner[at % wide];
    const y = ys.inner[Math.floor(at / wide)];
    const swell = Math.sin(x / 37 + 1.3) * Math.sin(y / 43 + 0.4) + 0.5 * Math.sin(x / 17 - y / 21);
    heights[at] += (swell - 0.4) * 3.2 * clamp((away[at] - 4) / 60, 0, 1);
  }
  return heights;
}

// Hands the heights at the road on to the rest, each place taking that of its nearest: two sweeps.
function spread(net, heights, away) {
  const { wide, high, cell } = net;
  const take = (at, from, distance) => {
    if (away[from] + distance < away[at]) {
      away[at] = away[from] + distance;
      heights[at] = heights[from];
    }
  };
  for (const isBack of [false, true, false, true]) {
    const turn = isBack ? -1 : 1;
    for (let j = isBack ? high - 1 : 0; j >= 0 && j < high; j += turn) {
      for (let i = isBack ? wide - 1 : 0; i >= 0 && i < wide; i += turn) {
        const at = j * wide + i;
        for (const [di, dj, far] of [[-turn, 0, 1], [0, -turn, 1], [-turn, -turn, 1.414], [turn, -turn, 1.414]]) {
          if (i + di < 0 || i + di >= wide || j + dj < 0 || j + dj >= high) continue;
          take(at, at + dj * wide + di, far * cell);
        }
      }
    }
  }
}

function smooth({ wide, high }, heights, fixed) {
  for (let j = 0; j < high; j++) {
    for (let i = 0; i < wide; i++) {
      const at = j * wide + i;
      if (fixed[at]) continue;
      const west = heights[i > 0 ? at - 1 : at];
      const east = heights[i < wide - 1 ? at + 1 : at];
      const south = heights[j > 0 ? at - wide : at];
      const north = heights[j < high - 1 ? at + wide : at];
      heights[at] = (west + east + south + north) / 4;
    }
  }
}

function landMesh(net, origin, grain) {
  const shape = new Shape3(origin);
  const colours = MEADOW.map(colourOf);
  const { xs, ys, wide, high } = net;
  const pad = FAR.length;
  const mean = net.heights.reduce((sum, height) => sum + height, 0) / net.heights.length;
  ys.all.forEach((y, j) => xs.all.forEach((x, i) => {
    const inner = clamp(j - pad, 0, high - 1) * wide + clamp(i - pad, 0, wide - 1);
    const isFar = Math.max(pad - i, pad - j, i - pad - wide + 1, j - pad - high + 1, 0);
    const level = mix(net.heights[inner], mean, isFar ? [0.5, 0.9, 1][isFar - 1] : 0);
    const tint = isFar ? 0.5 : 0.5 + 0.5 * Math.sin(x / 23 + 2 * Math.sin(y / 31)) * Math.sin(y / 19);
    shape.point(x, y, level, colours[1].clone().lerp(colours[tint > 0.5 ? 2 : 0], Math.abs(2 * tint - 1)));
  }));
  const row = xs.all.length;
  for (let j = 0; j + 1 < ys.all.length; j++) {
    for (let i = 0; i + 1 < row; i++) shape.quad(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
  }
  return shape.mesh(THREE.MeshLambertMaterial, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, map: grain });
}

function heightAt(net, x, y) {
  const at = (column, v) => clamp((v - column.inner[0]) / net.cell, 0, column.inner.length - 1.001);
  const [u, v] = [at(net.xs, x), at(net.ys, y)];
  const [i, j] = [Math.floor(u), Math.floor(v)];
  const row = (k) => mix(net.heights[k * net.wide + i], net.heights[k * net.wide + i + 1], u - i);
  return mix(row(j), row(j + 1), v - j);
}

const lineStep = (span) => GRID.find((step) => span / step <= 24) || GRID[GRID.length - 1];

// For the free camera, which looks from above: lines on the land at whole multiples of a step, those of the plan too; and the border of the map.
function landGrid(net, world, origin) {
  const group = new THREE.Group();
  const ends = [net.xs, net.ys].map(({ inner }) => [inner[0], inner[inner.length - 1]]);
  const step = lineStep(Math.max(ends[0][1] - ends[0][0], ends[1][1] - ends[1][0]));
  const points = [];
  const draw = (into, from, to) => {
    const parts = Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / (net.cell / 2)));
    for (let n = 0; n < parts; n++) {
      for (const share of [n / parts, (n + 1) / parts]) {
        const [x, y] = [mix(from[0], to[0], share), mix(from[1], to[1], share)];
        into.push(x - origin.x, y - origin.y, heightAt(net, x, y) + 0.12 - origin.z);
      }
    }
  };
  for (let x = Math.ceil(ends[0][0] / step) * step; x <= ends[0][1]; x += step) draw(points, [x, ends[1][0]], [x, ends[1][1]]);
  for (let y = Math.ceil(ends[1][0] / step) * step; y <= ends[1][1]; y += step) draw(points, [ends[0][0], y], [ends[0][1], y]);
  group.add(lines(points, { color: 0xffffff, opacity: 0.34 }));
  const border = [];
  const size = world.map_size;
  const inside = (v, [low, high]) => clamp(v, low, high);
  const corners = [[0, 0], [size, 0], [size, size], [0, size], [0, 0]];
  corners.slice(1).forEach(([x, y], i) => {
    const [x0, y0] = corners[i];
    const isSeen = x === x0 ? x >= ends[0][0] && x <= ends[0][1] : y >= ends[1][0] && y <= ends[1][1];
    if (isSeen) draw(border, [inside(x0, ends[0]), inside(y0, ends[1])], [inside(x, ends[0]), inside(y, ends[1])]);
  });
  group.add(lines(border, { color: 0x2d3a2a, opacity: 0.7 }));
  return group;
}

function lines(points, look) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, depthWrite: false, ...look }));
}

function sky() {
  const material = new THREE.ShaderMaterial({
    side: THREE.BackSide,
    depthWrite: false,
    fog: false,
    uniforms: { low: { value: colourOf(HORIZON) }, top: { value: colourOf(ZENITH) } },
    vertexShader: "varying vec3 way; void main() { way = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: "uniform vec3 low; uniform vec3 top; varying vec3 way; void main() { float h = max(normalize(way).z, 0.0);"
      + " gl_FragColor = vec4(mix(low, top, pow(h, 0.55)), 1.0);\n#include <colorspace_fragment>\n}",
  });
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(9000, 32, 16), material);
  mesh.renderOrder = -1;
  return mesh;
}
