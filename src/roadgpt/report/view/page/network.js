// Networks: level junctions with their islands, lines, signs, and the lane of the route.

const ON_ROUTE = 0x4f86b5; // as on the plan
const KERB_HIGH = 0.12; // m of a traffic island

// The roads that are swept along their lines: one, or all of a network outside its junctions.
const roadsOf = (scene) => (scene.network ? scene.network.roads : [scene.road]);

// Lists x, y, x, y as pairs, and x, y, z, x, y, z as triples.
function inGroups(values, size) {
  const out = [];
  for (let i = 0; i < values.length; i += size) out.push(values.slice(i, i + size));
  return out;
}

// A level area of triangles.
function plain(shape, { points, corners }, z, colour) {
  const first = shape.count;
  inGroups(points, 2).forEach(([x, y]) => shape.point(x, y, z, colour));
  corners.forEach((corner) => shape.corners.push(first + corner));
}

// How a line goes on at each of its points: a unit vector to its left.
function leftOf(line) {
  const last = line.length - 1;
  return line.map((_, i) => {
    const [x0, y0] = line[Math.max(i - 1, 0)];
    const [x1, y1] = line[Math.min(i + 1, last)];
    const long = Math.hypot(x1 - x0, y1 - y0) || 1;
    return [-(y1 - y0) / long, (x1 - x0) / long];
  });
}

// A wall below a ring that runs counter-clockwise, from height z0 to z1.
function wall(shape, line, z0, z1, colour) {
  const rows = [z1, z0].map((z) => line.map(([x, y]) => shape.point(x, y, z, colour)));
  line.forEach((_, i) => {
    const next = (i + 1) % line.length;
    shape.quad(rows[0][i], rows[0][next], rows[1][next], rows[1][i]);
  });
}

function junctions(paved, verge, { areas }, isLaid) {
  const { asphalt, concrete, gravel } = COLOURS;
  for (const { z, paved: carriageway, shoulder: [bare, ...grown], green, kerbed, rims } of areas) {
    plain(paved, carriageway, z, asphalt);
    if (bare) plain(verge, bare, z - LOWER, gravel);
    [...grown, ...green].forEach((part) => plain(verge, part, z - LOWER, grassAt));
    for (const island of kerbed) {
      plain(paved, island, z + KERB_HIGH, concrete);
      wall(paved, inGroups(island.rim, 2), z + KERB_HIGH, z, concrete);
    }
    if (!isLaid) for (const rim of rims) wall(paved, inGroups(rim, 2), z - 0.001, z - THICK, concrete);
  }
}

const ABOVE_ROAD = (order) => ({ polygonOffset: true, polygonOffsetFactor: -order, polygonOffsetUnits: -order });

// Everything that is painted, and the tint of the lane that the route takes.
function networkMarkings(scene, origin) {
  const { paint } = COLOURS;
  const lines = new Shape3(origin);
  for (const { width, points } of scene.network.strokes) {
    const line = inGroups(points, 3);
    const left = leftOf(line);
    const sides = [1, -1].map((side) => line.map(([x, y, z], i) => lines.point(
      x + (side * width * left[i][0]) / 2, y + (side * width * left[i][1]) / 2, z + 0.015, paint,
    )));
    for (let i = 1; i < line.length; i++) lines.quad(sides[1][i - 1], sides[1][i], sides[0][i], sides[0][i - 1]);
  }
  for (const { points, corners } of scene.network.arrows) {
    const first = lines.count;
    inGroups(points, 3).forEach(([x, y, z]) => lines.point(x, y, z + 0.015, paint));
    corners.forEach((corner) => lines.corners.push(first + corner));
  }
  const tint = new Shape3(origin);
  const { bounds, driven } = scene.road.lanes;
  if (scene.network.hasRoute) band(tint, scene.road, scene.road.s, [bounds[driven].t, 0.006], [bounds[driven + 1].t, 0.006], colourOf(ON_ROUTE));
  const group = new THREE.Group();
  group.add(tint.mesh(THREE.MeshLambertMaterial, { transparent: true, opacity: 0.3, depthWrite: false, ...ABOVE_ROAD(1) }), lines.mesh(THREE.MeshLambertMaterial, ABOVE_ROAD(2)));
  return group;
}

// The network on the plan: px and py turn metres into pixels, scale is pixels in a metre.
function paintNetwork(pen, { network, road }, px, py, scale) {
  const areas = (rings, style) => {
    pen.beginPath();
    for (const ring of rings) {
      inGroups(ring, 2).forEach(([x, y], i) => (i ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
      pen.closePath();
    }
    pen.fillStyle = style;
    pen.fill("evenodd");
  };
  const { ground, paved, kerbed, green } = network.plan;
  areas(ground, LOOK.verge);
  areas(paved, LOOK.asphalt);
  areas([...green, ...network.roads.filter(({ lanes }) => lanes.median).map(greenOf)], LOOK.meadow);
  areas(kerbed, LOOK.verge);
  const { bounds, driven } = road.lanes;
  const sides = [bounds[driven].t, bounds[driven + 1].t].map((t) => road.s.map((s) => beside(road, s, offsetAt(road, t, s))));
  pen.fillStyle = pen.strokeStyle = "#4f86b5";
  pen.lineWidth = 0.6;
  for (let i = 1; network.hasRoute && i < road.s.length; i++) {
    pen.beginPath();
    [sides[0][i - 1], sides[0][i], sides[1][i], sides[1][i - 1]].forEach(([x, y], k) => (k ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
    pen.fill();
    pen.stroke();
  }
  if (road.lanes.reach * scale < 3) return;
  pen.strokeStyle = "#fff";
  for (const { kind, points } of network.strokes) {
    if (kind === "edge") continue;
    pen.lineWidth = kind === "lane" ? 0.8 : 1.6;
    pen.beginPath();
    inGroups(points, 3).forEach(([x, y], i) => (i ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
    pen.stroke();
  }
  areas(network.arrows.map(({ points }) => inGroups(points, 3).flatMap(([x, y]) => [x, y])), "#fff");
}
