// The stage: all that is seen in 3-D of one road, in metres with z up, near the origin for the sake of float32.

const ORDINARY_VIEW = 52, TALL_VIEW = 68; // degrees upright, on wide and on tall screens

const SMALL = 70; // m, from where a car can hardly be seen
const AFAR = 0.8; // of the road's radius, from where the road itself can hardly be seen
const THICK_LINE = 0.006; // width of the line that shows it then, of the camera's distance

function makeStage(canvas, scene, trip, fastest) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
  const roads = roadsOf(scene);
  const [x, y, z] = ["x", "y", "z"].map((name) => roads.flatMap((road) => road[name]));
  const ends = [extent(x), extent(y), extent(z)];
  const origin = { x: (ends[0][0] + ends[0][1]) / 2, y: (ends[1][0] + ends[1][1]) / 2, z: ends[2][0] };
  const radius = Math.max(30, Math.hypot(...ends.map(([low, high]) => high - low)) / 2);

  const world = new THREE.Scene();
  world.fog = new THREE.Fog(COLOURS.haze, 0, HAZE);
  const [dome, wood] = [sky(), trees(scene, origin)];
  const lights = daylight();
  world.add(dome, wood.group, ...lights);
  world.add(landMesh(scene, origin, meadowGrain(renderer)), pavement(scene, origin, renderer));
  if (hasEnds(scene)) world.add(startAndGoal(scene, origin));
  world.add(scene.network ? networkMarkings(scene, origin) : markings(scene, origin), signMeshes(scene, origin));
  for (const road of roads) if (road.lanes.shoulder > 0.5) world.add(posts(road, origin));
  const line = scene.drive ? lineAlong(scene, origin, fastest) : new THREE.Group();
  const afar = hasEnds(scene) ? lineAlong(scene, origin, fastest, Math.max(1.01, (2 * radius * THICK_LINE) / 0.42)) : new THREE.Group();
  world.add(line, afar);
  const plates = canvas.parentElement.querySelector(".plates");
  const pins = scene.places.map((place) => {
    // a car that took a wrong turn stands on another road, which may be higher
    const z = place.isMinor && trip.isDriven ? trip.at(place.time).z - trip.car.height : onRoad(scene.road, place.s, 0).z;
    const letters = place.colour === scene.severe.failed ? "#c04f00" : place.letters;
    return pin(plates, place.x - origin.x, place.y - origin.y, z - origin.z, { ...place, letters });
  });
  pins.forEach(({ group }) => world.add(group));
  const corners = [".hud", ".legend", ".hint"].map((name) => canvas.parentElement.querySelector(name));
  const car = trip.isDriven ? makeCar(trip.car) : makePointer();
  const dot = beacon();
  world.add(car.group, dot);
  const others = scene.others && makeOthers(scene);
  if (others) world.add(others.group);
  const weather = scene.weather && makeWeather(scene, world, { dome, wood, lights, car, others });
  let now = 0;

  const camera = new THREE.PerspectiveCamera(ORDINARY_VIEW, 1, 0.5, Math.max(20000, 8 * radius));
  camera.up.set(0, 0, 1);

  const middle = new THREE.Vector3(0, 0, (ends[2][1] - ends[2][0]) / 2);

  return {
    camera, canvas, origin, radius, line, middle,
    landAt: landHeights(scene, origin),
    plates: [],
    outline: x.map((each, i) => new THREE.Vector3(each - origin.x, y[i] - origin.y, z[i] - origin.z).sub(middle)),
    fit() {
      const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
      if (!wide || !high) return;
      renderer.setSize(wide, high, false);
      camera.aspect = wide / high;
      camera.fov = camera.aspect < 0.9 ? TALL_VIEW : ORDINARY_VIEW;
      camera.updateProjectionMatrix();
    },
    place(pose) {
      car.show(pose, origin, severeColour(scene, pose));
      dot.position.copy(car.group.position);
      if (others) others.show(pose.time, origin);
      now = pose.time;
    },
    // `away` is how far the free camera is from what it looks at: the road has no haze for it; 0 for the others.
    draw(away, hasLine) {
      const least = clamp(away / 50, 0.2, 100); // of what is drawn at all: the larger, the finer are depths told apart
      if (camera.near !== least) {
        camera.near = least;
        camera.updateProjectionMatrix();
      }
      world.fog.near = away && away + Math.min(away, radius);
      world.fog.far = world.fog.near + HAZE + (away && radius);
      dome.position.copy(camera.position);
      wood.face(camera);
      if (weather) weather.show(camera, away, now);
      const isFar = away > 60 + AFAR * radius;
      line.visible = hasLine && !isFar;
      afar.visible = isFar && (hasLine || !scene.drive);
      dot.visible = camera.position.distanceTo(dot.position) > SMALL;
      this.plates = layPlates(pins, camera, canvas, corners);
      renderer.render(world, camera);
    },
  };
}
