// What the page uses of three.js; README.md says how three.min.js is made of it.
export {
  AdditiveBlending, BoxGeometry, BufferGeometry, CanvasTexture, Color, ConeGeometry, CylinderGeometry,
  DirectionalLight, DoubleSide, Float32BufferAttribute, Fog, FogExp2, Group, HemisphereLight, InstancedMesh,
  LineBasicMaterial, LineSegments, LinearFilter, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  MeshStandardMaterial, PerspectiveCamera, Quaternion, RepeatWrapping, SRGBColorSpace, Scene, SphereGeometry,
  SpotLight, Sprite, SpriteMaterial, TorusGeometry, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
