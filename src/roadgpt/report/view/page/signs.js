// Signs beside the road, posts, start and goal, and pins where the car did wrong or a rule objects.

const POST_EVERY = 25; // m; half of what German rules ask for on straights, so that speed is seen
const FRONT = 0; // three.js's FrontSide: signs are grey behind
const AIR = 4; // pixels around a plate
const CLOSE = 9; // m, from where a pin would stand in the way of the look

// Faces of signs shine by themselves, as if headlamps shone on them; what is grey does not.
function signMeshes({ network }, origin) {
  const [plain, bright] = [new Shape3(origin), new Shape3(origin)];
  for (const { colour, points } of network ? network.signs : []) {
    const shape = colour === "grey" ? plain : bright;
    const paint = COLOURS[colour];
    const corners = inGroups(points, 3).map(([x, y, z]) => shape.point(x, y, z, paint));
    for (let i = 2; i < corners.length; i++) shape.corners.push(corners[0], corners[i - 1], corners[i]);
  }
  const group = new THREE.Group();
  group.add(plain.mesh(THREE.MeshLambertMaterial, { side: FRONT }), bright.mesh(THREE.MeshBasicMaterial, { side: FRONT }));
  return group;
}

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
function pin(plates, x, y, z, { text, letters, isMinor }) {
  const high = isMinor ? 2.4 : 3.4;
  const group = new THREE.Group();
  const paint = new THREE.MeshLambertMaterial({ color: colourOf(letters) });
  const pole = new THREE.Mesh(new THREE.CylinderGeometry(0.045, 0.045, high, 8), paint);
  pole.rotation.x = Math.PI / 2;
  pole.position.set(x, y, z + high / 2);
  const ball = new THREE.Mesh(new THREE.SphereGeometry(0.2, 16, 12), paint);
  ball.position.set(x, y, z + high);
  group.add(pole, ball);
  if (!text) return { group };
  const plate = document.createElement("div");
  plate.className = isMinor ? "plate minor" : "plate";
  plate.textContent = text;
  plate.style.color = letters;
  plates.append(plate);
  return { group, plate, top: new THREE.Vector3(x, y, z + high + 0.3) };
}

// Lays plates over their pins, inside the picture and beside each other, the nearest first, and none over what
// stands in the corners. Gives back where they are, in pixels from the picture's upper left corner.
function layPlates(pins, camera, canvas, corners) {
  camera.updateMatrixWorld();
  const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
  const seen = [];
  for (const { group, plate, top } of pins) {
    const far = camera.position.distanceTo(group.children[1].position);
    group.visible = far > CLOSE;
    if (!plate) continue;
    const { x, y, z } = top.clone().project(camera);
    const isSeen = group.visible && z < 1 && Math.abs(x) < 1 && Math.abs(y) < 1;
    plate.hidden = !isSeen;
    if (isSeen) seen.push({ plate, far, x: ((1 + x) * wide) / 2, y: ((1 - y) * high) / 2, w: plate.offsetWidth, h: plate.offsetHeight });
  }
  const placed = corners.map(({ offsetLeft: left, offsetTop: top, offsetWidth: w, offsetHeight: h }) => ({ left, top, right: left + w, bottom: top + h }));
  const own = [];
  for (const { plate, x, y, w, h } of seen.sort((a, b) => a.far - b.far)) {
    const left = clamp(x - w / 2, AIR, Math.max(AIR, wide - w - AIR));
    const hit = (top) => placed.find((each) => left < each.right && left + w > each.left && top < each.bottom && top + h > each.top);
    const upwards = (top) => { for (let one; (one = hit(top)); ) top = one.top - h - AIR; return top; };
    const downwards = (top) => { for (let one; (one = hit(top)); ) top = one.bottom + AIR; return top; };
    const start = clamp(y - h, AIR, high - h - AIR);
    let top = upwards(start);
    if (top < AIR) top = downwards(start);
    plate.style.transform = `translate(${left}px, ${top}px)`;
    plate.style.setProperty("--at", `${clamp(x - left, 2, w - 2)}px`);
    plate.style.setProperty("--leg", `${Math.max(0, y - top - h)}px`);
    placed.push({ left, top, right: left + w, bottom: top + h });
    own.push(placed[placed.length - 1]);
  }
  return own;
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
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, fog: false, transparent: true }));
  sprite.scale.set(0.026, 0.026, 1);
  sprite.renderOrder = 3;
  return sprite;
}
