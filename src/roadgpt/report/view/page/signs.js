// Signs: start and goal, posts beside the road, and pins where the car did wrong or a rule objects.

const POST_EVERY = 25; // m; half of what German rules ask for on straights, so that speed is seen
const PLATE = 0.00082; // of the height of the picture, per pixel of text
const MINOR = 0.75; // size of a plate whose place caused no failure, of the others'

function posts(road, origin) {
  const { left, right } = road.lanes.rims;
  const count = Math.max(1, Math.floor(road.length / POST_EVERY));
  const body = new THREE.InstancedMesh(new THREE.BoxGeometry(0.12, 0.12, 1), new THREE.MeshLambertMaterial({ color: 0xf7f7f5 }), 2 * count);
  const dark = new THREE.InstancedMesh(new THREE.BoxGeometry(0.13, 0.13, 0.22), new THREE.MeshLambertMaterial({ color: 0x22252a }), 2 * count);
  const matrix = new THREE.Matrix4();
  for (let n = 0; n < count; n++) {
    for (const side of [1, -1]) {
      const s = (n + 0.5) * (road.length / count);
      const [x, y, z] = beside(road, s, offsetAt(road, side > 0 ? left : right, s) - side * 0.25);
      const at = 2 * n + (side > 0 ? 0 : 1);
      matrix.makeTranslation(x - origin.x, y - origin.y, z + 0.45 - origin.z);
      body.setMatrixAt(at, matrix);
      matrix.makeTranslation(x - origin.x, y - origin.y, z + 0.72 - origin.z);
      dark.setMatrixAt(at, matrix);
    }
  }
  const group = new THREE.Group();
  group.add(body, dark);
  return group;
}

// A map without a route has neither start nor goal.
const hasEnds = ({ network }) => !network || network.hasRoute;

// A white line at the start, a chequered band at the goal, both over the driven lane.
function startAndGoal(scene, origin) {
  const { road } = scene;
  const { bounds, driven } = road.lanes;
  const shape = new Shape3(origin);
  const white = colourOf(0xffffff);
  const black = colourOf(0x15171a);
  const [left, right] = [bounds[driven].t, bounds[driven + 1].t];
  const start = Math.min(0.6, road.length);
  band(shape, road, stationsBetween(road, Math.max(0, start - 0.5), start), [left, 0.02], [right, 0.02], white);
  const count = 8;
  for (let row = 0; row < 2; row++) {
    const a = Math.max(0, road.length - 1 + 0.5 * row);
    const stations = stationsBetween(road, a, Math.min(road.length, a + 0.5));
    for (let k = 0; k < count; k++) {
      const tile = (k + row) % 2 ? white : black;
      band(shape, road, stations, [between(left, right, k / count), 0.02], [between(left, right, (k + 1) / count), 0.02], tile);
    }
  }
  return shape.mesh(THREE.MeshLambertMaterial, { polygonOffset: true, polygonOffsetFactor: -3, polygonOffsetUnits: -3 });
}

// A pole with a ball and, if there is text, a plate over a place; lower and smaller where it caused no failure.
function pin(x, y, z, text, colour, isMinor) {
  const high = isMinor ? 2.4 : 3.4;
  const group = new THREE.Group();
  const paint = new THREE.MeshLambertMaterial({ color: colour });
  const pole = new THREE.Mesh(new THREE.CylinderGeometry(0.045, 0.045, high, 8), paint);
  pole.rotation.x = Math.PI / 2;
  pole.position.set(x, y, z + high / 2);
  const ball = new THREE.Mesh(new THREE.SphereGeometry(0.2, 16, 12), paint);
  ball.position.set(x, y, z + high);
  group.add(pole, ball);
  if (!text) return { group };
  const sprite = plate(text, css(rgbOf(colour)), isMinor ? MINOR : 1);
  sprite.position.set(x, y, z + high + 0.35);
  group.add(sprite);
  return { group, sprite };
}

// Moves plates up that would cover another one on the screen: the nearest stays where it is. Gives back where they
// are, from the middle of the screen, which reaches from -1 to 1 either way.
function keepApart(pins, camera) {
  camera.updateMatrixWorld();
  const tall = 2 * Math.tan((camera.fov * Math.PI) / 360);
  const plates = pins.map(({ sprite }) => {
    const seen = sprite.position.clone().project(camera);
    const [wide, high] = [(2 * sprite.scale.x) / (tall * camera.aspect), (2 * sprite.scale.y) / tall];
    return { sprite, x: seen.x, y: seen.y, wide, high, far: camera.position.distanceTo(sprite.position), isSeen: seen.z < 1 };
  });
  const placed = [];
  for (const plate of plates.filter(({ isSeen }) => isSeen).sort((a, b) => a.far - b.far)) {
    let bottom = plate.y;
    for (const other of placed) {
      const isBeside = Math.abs(other.x - plate.x) >= (other.wide + plate.wide) / 2;
      if (!isBeside && bottom < other.bottom + other.high && bottom + plate.high > other.bottom) bottom = other.bottom + other.high;
    }
    placed.push({ ...plate, bottom });
    placed.sort((a, b) => a.bottom - b.bottom);
    plate.sprite.center.set(0.5, -(bottom - plate.y) / plate.high);
  }
  return placed.map(({ x, bottom, wide, high }) => ({ left: x - wide / 2, right: x + wide / 2, bottom, top: bottom + high }));
}

// A dot that tells from afar where the car is.
function beacon() {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  pen.arc(32, 32, 24, 0, 7);
  pen.fillStyle = HERE;
  pen.fill();
  pen.lineWidth = 8;
  pen.strokeStyle = "#fff";
  pen.stroke();
  const sprite = onScreen(canvas);
  sprite.scale.set(0.026, 0.026, 1);
  return sprite;
}

// A picture that keeps its size on the screen, whatever its distance.
function onScreen(canvas) {
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  return new THREE.Sprite(new THREE.SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, fog: false, transparent: true }));
}

const rgbOf = (hex) => [(hex >> 16) & 255, (hex >> 8) & 255, hex & 255];

function plate(text, colour, size) {
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  const rows = text.split("\n").slice(0, 4);
  const font = "600 30px system-ui, sans-serif";
  pen.font = font;
  const wide = Math.ceil(Math.max(...rows.map((row) => pen.measureText(row).width))) + 32;
  const high = rows.length * 36 + 20;
  canvas.width = wide;
  canvas.height = high;
  pen.font = font;
  pen.fillStyle = "rgba(255,255,255,0.92)";
  pen.beginPath();
  pen.roundRect(1, 1, wide - 2, high - 2, 12);
  pen.fill();
  pen.fillStyle = colour;
  pen.textBaseline = "middle";
  rows.forEach((row, i) => pen.fillText(row, 16, 29 + i * 36));
  const sprite = onScreen(canvas);
  sprite.scale.set(wide * PLATE * size, high * PLATE * size, 1);
  sprite.center.set(0.5, 0);
  sprite.renderOrder = 10;
  return sprite;
}
