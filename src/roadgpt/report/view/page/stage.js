// The stage: all that is seen in 3-D of one road, in metres with z up, near the origin for the sake of float32.

const ORDINARY_VIEW = 52, TALL_VIEW = 68; // degrees upright, on wide and on tall screens

const SMALL = 70; // m, from where a car can hardly be seen

function makeStage(canvas, scene, trip, fastest) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
  const roads = roadsOf(scene);
  const [x, y, z] = ["x", "y", "z"].map((name) => roads.flatMap((road) => road[name]));
  const ends = [extent(x), extent(y), extent(z)];
  const origin = { x: (ends[0][0] + ends[0][1]) / 2, y: (ends[1][0] + ends[1][1]) / 2, z: ends[2][0] };
  const radius = Math.max(30, Math.hypot(...ends.map(([low, high]) => high - low)) / 2);

  const world = new THREE.Scene();
  world.fog = new THREE.Fog(HORIZON, Math.max(250, 2 * radius), Math.max(2500, 9 * radius));
  const dome = sky();
  world.add(dome, new THREE.HemisphereLight(0xf3f8ff, 0x8a9470, 2.1));
  const sun = new THREE.DirectionalLight(0xfff2dc, 2.0);
  sun.position.set(-0.45, -0.6, 0.8);
  world.add(sun);

  const net = landOf(scene);
  const grid = landGrid(net, scene.world, origin);
  world.add(landMesh(net, origin, meadowGrain(renderer)), grid);
  world.add(pavement(scene, origin, net.bank, asphaltGrain(renderer)));
  if (hasEnds(scene)) world.add(startAndGoal(scene, origin));
  if (scene.network) world.add(networkMarkings(scene, origin), networkSigns(scene.network, origin));
  else world.add(markings(scene, origin));
  for (const road of roads) if (road.lanes.shoulder > 0.5) world.add(posts(road, origin));
  const line = scene.drive ? drivenLine(scene, origin, fastest) : new THREE.Group();
  world.add(line);
  const pins = scene.places.map((place) => {
    // a car that took a wrong turn stands on another road, which may be higher
    const z = place.isMinor && trip.isDriven ? trip.at(place.time).z - trip.car.height : onRoad(scene.road, place.s, 0).z;
    const colour = place.colour === scene.severe.failed ? 0xc04f00 : parseInt(place.letters.slice(1), 16);
    return pin(place.x - origin.x, place.y - origin.y, z - origin.z, place.text, colour, place.isMinor);
  });
  pins.forEach(({ group }) => world.add(group));
  const car = trip.isDriven ? makeCar(trip.car) : makePointer();
  const dot = beacon();
  world.add(car.group, dot);

  const camera = new THREE.PerspectiveCamera(ORDINARY_VIEW, 1, 0.5, 20000);
  camera.up.set(0, 0, 1);

  const middle = new THREE.Vector3(0, 0, (ends[2][1] - ends[2][0]) / 2);

  return {
    camera, canvas, origin, radius, line, middle, grid,
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
      car.show(pose, origin, severeColour(scene, pose.outside || 0));
      dot.position.copy(car.group.position);
    },
    draw() {
      dome.position.copy(camera.position);
      dot.visible = camera.position.distanceTo(dot.position) > SMALL;
      this.plates = keepApart(pins.filter(({ sprite }) => sprite), camera);
      renderer.render(world, camera);
    },
  };
}
