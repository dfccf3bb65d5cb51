// The land around the road, its trees and the sky: those of films, which the page holds as data.

const COLOURS = Object.fromEntries(Object.entries(SCENERY.colours).map(([name, rgb]) => [name, new THREE.Color(...rgb)]));
const CENTI = 100; // lengths of the land are told in centimetres
const CELL = 4; // m, side of the squares in which points of the land are looked for
const LOWER = 0.02; // m by which verges and the land lie below the asphalt
const DOME = 9000; // m, radius of the sky
const HAZE = 1300; // m, depth in which all becomes haze: about as films have it

function pictureOf(address) {
  const picture = new Image();
  picture.src = address;
  return picture;
}

const PICTURES = { sky: pictureOf(SCENERY.sky.picture), trees: pictureOf(SCENERY.trees) };

// Whole numbers of 32 bits, little-endian, from text.
const numbersOf = (text) => new Int32Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);

// Grass is drier in some places than in others.
function grassAt(x, y) {
  const wide = 1.3 * Math.sin(x / 47 + 1.7 * Math.sin(y / 61)) * Math.sin(y / 39 - x / 97) + 0.8 * Math.sin(x / 17 + y / 29) * Math.sin(y / 13 - x / 23);
  return COLOURS.lush.clone().lerp(COLOURS.dry, clamp(0.42 + 0.27 * wide, 0, 1)).multiplyScalar(1 + 0.12 * wide);
}

// The ground or the water: `look` gives the colour of each point from its place and how steep it is, 0 to 1.
function landShape({ points, corners }, origin, look, down) {
  const shape = new Shape3(origin);
  const [all, steep] = [numbersOf(points), []];
  const at = (i) => [all[3 * i] / CENTI, all[3 * i + 1] / CENTI, all[3 * i + 2] / CENTI];
  shape.corners = Array.from(numbersOf(corners));
  inGroups(shape.corners, 3).forEach((triangle) => {
    const [a, b, c] = triangle.map(at);
    const [u, v] = [b, c].map((p) => new THREE.Vector3(p[0] - a[0], p[1] - a[1], p[2] - a[2]));
    const up = u.cross(v).normalize().z;
    for (const i of triangle) steep[i] = Math.max(steep[i] || 0, 1 - up);
  });
  for (let i = 0; 3 * i < all.length; i++) {
    const [x, y, z] = at(i);
    shape.point(x, y, z - down, look(x, y, steep[i] || 0));
  }
  return shape;
}

function landMesh({ land }, origin, grain) {
  const { from, to } = SCENERY.rock;
  const { middle, wide } = land;
  const look = (x, y, steep) => {
    // far points lie too wide apart for what is dry and what is not
    const isFar = Math.max(Math.abs(x - middle[0]), Math.abs(y - middle[1])) > wide;
    return (isFar ? grassAt(0, 0) : grassAt(x, y)).clone().lerp(COLOURS.rock, clamp((steep - from) / (to - from), 0, 1));
  };
  const group = new THREE.Group();
  group.add(landShape(land.ground, origin, look, LOWER).mesh(THREE.MeshLambertMaterial, grain));
  if (land.water.corners) group.add(landShape(land.water, origin, () => COLOURS.water, 0).mesh());
  if (land.solids.corners) group.add(landShape(land.solids, origin, () => COLOURS.concrete, LOWER).mesh());
  return group;
}

// A function that gives the height of the land at a place: that of the nearest point within a few metres.
function landHeights({ land }, origin) {
  const all = numbersOf(land.ground.points);
  const cells = new Map();
  const key = (x, y) => `${Math.floor(x / CELL)} ${Math.floor(y / CELL)}`;
  for (let i = 0; i < all.length; i += 3) {
    const [x, y, z] = [all[i] / CENTI - origin.x, all[i + 1] / CENTI - origin.y, all[i + 2] / CENTI - origin.z];
    const name = key(x, y);
    cells.set(name, [...(cells.get(name) || []), [x, y, z]]);
  }
  return ({ x, y }) => {
    const near = [-1, 0, 1].flatMap((a) => [-1, 0, 1].flatMap((b) => cells.get(key(x + a * CELL, y + b * CELL)) || []));
    const away = near.map((point) => Math.hypot(point[0] - x, point[1] - y));
    const at = away.indexOf(Math.min(...away));
    return at < 0 ? -Infinity : near[at][2];
  };
}

function textureOf(picture) {
  const texture = new THREE.CanvasTexture(picture);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

// Upright pictures, all of them turned to the camera before it looks.
function trees({ land }, origin) {
  const map = textureOf(PICTURES.trees);
  const looks = map.image.naturalWidth / map.image.naturalHeight;
  const material = new THREE.MeshBasicMaterial({ map, alphaTest: 0.4, side: THREE.DoubleSide });
  const corners = new THREE.Float32BufferAttribute(12, 3);
  const group = new THREE.Group();
  const all = inGroups(land.trees, 7);
  for (let look = 0; look < looks; look++) {
    const own = all.filter((tree) => tree[5] === look);
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", corners);
    shape.setAttribute("uv", new THREE.Float32BufferAttribute([0, 0, 1, 0, 1, 1, 0, 1].map((v, k) => (k % 2 ? v : (look + v) / looks)), 2));
    shape.setIndex([0, 1, 2, 0, 2, 3]);
    const mesh = new THREE.InstancedMesh(shape, material, own.length);
    own.forEach(([x, y, z, high, wide, , tint], n) => {
      const size = new THREE.Matrix4().makeScale(wide / 10, wide / 10, high / 10);
      mesh.setMatrixAt(n, size.setPosition(x / 10 - origin.x, y / 10 - origin.y, z / 10 - origin.z));
      mesh.setColorAt(n, new THREE.Color(tint / 100, tint / 100, tint / 100));
    });
    mesh.frustumCulled = false; // its corners move
    group.add(mesh);
  }
  return {
    group,
    face(camera) {
      const { x, y } = camera.getWorldDirection(new THREE.Vector3());
      const long = 2 * Math.hypot(x, y) || 1;
      [[-1, 0], [1, 0], [1, 1], [-1, 1]].forEach(([side, up], k) => corners.setXYZ(k, (side * y) / long, (-side * x) / long, up));
      corners.needsUpdate = true;
    },
  };
}

function sky() {
  const [round, high] = [48, 24];
  const [points, places, corners] = [[], [], []];
  for (let j = -1; j <= high; j++) {
    const v = Math.max(0, j) / high;
    const up = j < 0 ? -Math.PI / 2 : mix(SCENERY.sky.lowest, Math.PI / 2, v * v);
    for (let i = 0; i <= round; i++) {
      const turn = (2 * Math.PI * i) / round;
      points.push(DOME * Math.cos(up) * Math.cos(turn), DOME * Math.cos(up) * Math.sin(turn), DOME * Math.sin(up));
      places.push(i / round, v);
      const at = (j + 1) * (round + 1) + i;
      if (j < high && i < round) corners.push(at, at + 1, at + round + 2, at, at + round + 2, at + round + 1);
    }
  }
  const shape = new THREE.BufferGeometry();
  shape.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  shape.setAttribute("uv", new THREE.Float32BufferAttribute(places, 2));
  shape.setIndex(corners);
  const map = textureOf(PICTURES.sky);
  map.generateMipmaps = false;
  map.minFilter = THREE.LinearFilter;
  const mesh = new THREE.Mesh(shape, new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide, depthWrite: false, fog: false }));
  mesh.renderOrder = -1;
  mesh.frustumCulled = false;
  return mesh;
}

function daylight() {
  const { sun, direct, above, below } = SCENERY.light;
  const grey = (light) => new THREE.Color(light, light, light).multiplyScalar(Math.PI);
  const ambient = new THREE.HemisphereLight(grey(above), grey(below), 1);
  ambient.position.set(0, 0, 1);
  const bright = new THREE.DirectionalLight(grey(direct), 1);
  bright.position.set(...sun);
  return [ambient, bright];
}
