// Cameras: behind the car, over its hood, and free. The first two depend on the time alone, so that the slider
// may jump.

const AHEAD = 7; // m before the car, where the camera behind it looks
const FILLED = 0.84; // of the picture, by the road seen as a whole
const [OVER_LAND, UNDER_ROOFS] = [0.6, 3.5]; // m, of a camera above land; a tunnel's roof is higher above it
const LAG = 0.5; // s by which the camera behind the car turns later than the car

function makeCameras(stage, trip, onDrag) {
  const { camera, origin } = stage;
  const controls = new THREE.OrbitControls(camera, stage.canvas);
  controls.minDistance = 3;
  controls.maxDistance = Math.max(400, 6 * stage.radius);
  controls.maxPolarAngle = 0.495 * Math.PI;
  controls.zoomSpeed = 1.4;
  let mode = "behind";
  let isHeld = false;
  let isOverview = false; // and nobody has moved it since

  const spot = (pose) => new THREE.Vector3(pose.x - origin.x, pose.y - origin.y, pose.z - origin.z);

  function behind(time) {
    const now = trip.at(time);
    const before = trip.at(Math.max(0, time - LAG));
    const heading = mix(before.heading, now.heading, 0.5);
    const slope = Math.tan(mix(before.pitch, now.pitch, 0.5));
    const car = spot(now);
    const way = new THREE.Vector3(Math.cos(heading), Math.sin(heading), slope);
    const { ahead, up } = SCENERY.mounts.chase;
    camera.position.copy(car).addScaledVector(way, ahead);
    camera.position.z += up - trip.car.height;
    const lift = stage.landAt(camera.position) + OVER_LAND - camera.position.z;
    if (lift > 0 && lift < UNDER_ROOFS) camera.position.z += lift;
    camera.lookAt(car.clone().addScaledVector(way, AHEAD));
    controls.target.copy(car);
  }

  function bonnet(time) {
    const pose = trip.at(time);
    const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), pose.heading)
      .multiply(new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 1, 0), -pose.pitch))
      .multiply(new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), pose.roll));
    const car = spot(pose);
    const { ahead, up, tilt } = SCENERY.mounts.bonnet;
    const eye = new THREE.Vector3(ahead, 0, up - trip.car.height).applyQuaternion(turn);
    const way = new THREE.Vector3(1, 0, camera.aspect < 0.9 ? 0.05 : Math.tan(tilt)).applyQuaternion(turn);
    camera.position.copy(car).add(eye);
    camera.up.set(0, 0, 1).applyQuaternion(turn);
    camera.lookAt(camera.position.clone().add(way));
    camera.up.set(0, 0, 1);
    controls.target.copy(car);
  }

  // Orbiting needs no update: its controls move the camera when they are used.
  function overview() {
    const back = new THREE.Vector3(0.1, -0.8, 0.56).normalize();
    const right = new THREE.Vector3(0, 0, 1).cross(back).normalize();
    const up = back.clone().cross(right);
    const tall = FILLED * Math.tan((camera.fov * Math.PI) / 360);
    const wide = tall * camera.aspect;
    let far = 20;
    for (const corner of stage.outline) {
      const spread = Math.max(Math.abs(corner.dot(right)) / wide, Math.abs(corner.dot(up)) / tall);
      far = Math.max(far, spread + corner.dot(back));
    }
    controls.target.copy(stage.middle);
    camera.position.copy(stage.middle).addScaledVector(back, far);
    controls.update();
    isOverview = true;
  }

  function toCar(time) {
    isOverview = false;
    const car = spot(trip.at(time));
    const away = camera.position.clone().sub(controls.target).setLength(24);
    if (away.z < 6) away.setZ(9);
    controls.target.copy(car);
    camera.position.copy(car).add(away);
    controls.update();
  }

  controls.addEventListener("start", () => {
    isHeld = true;
    isOverview = false;
  });
  controls.addEventListener("end", () => { isHeld = false; });
  controls.addEventListener("change", () => onDrag(isHeld && mode !== "free"));

  return {
    controls, overview, toCar,
    // How far the free camera is from what it looks at.
    get away() { return mode === "free" ? controls.getDistance() : 0; },
    // On a window of another shape the whole road is shown anew.
    fit() {
      if (mode === "free" && isOverview) overview();
    },
    choose(name) {
      mode = name;
    },
    follow(time) {
      if (isHeld) return;
      if (mode === "behind") behind(time);
      if (mode === "bonnet") bonnet(time);
    },
  };
}
