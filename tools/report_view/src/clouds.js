// Clouds as the report embeds them: per station base64 of N x (x, y, z) uint16, N x 2 bytes of octahedral normal, then N
// bytes of intensity if there is any; little endian. The points stand in random order: any first part is an even sample.
import { BufferAttribute, BufferGeometry, Points, ShaderMaterial, Vector3, Color } from "three";

export const bytesOf = text => {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) bytes[k] = raw.charCodeAt(k);
  return bytes;
};

const vertexShader = `
attribute vec2 octahedral;
attribute float intensity;
uniform vec3 up;
uniform vec3 own, faint;
uniform vec2 heights;
uniform float cut, size, pixels, voxel, dim;
uniform int mode;
varying vec3 shade;
varying float gone;
vec3 ramp(float t) {  // viridis, a polynomial fit
  t = clamp(t, 0.0, 1.0);
  return clamp(vec3(0.280, 0.004, 0.334) + t * (vec3(0.107, 1.404, 1.385) + t * (vec3(-0.330, 0.215, 0.095) +
    t * (vec3(-4.634, -5.799, -19.332) + t * (vec3(6.228, 14.180, 56.691) + t * (vec3(4.776, -13.745, -65.353) +
    t * vec3(-5.435, 4.646, 26.312)))))), 0.0, 1.0);
}
void main() {
  vec4 p = modelMatrix * vec4(position, 1.0);
  float height = dot(p.xyz, up);
  gone = height > cut ? 1.0 : 0.0;
  vec2 o = octahedral / 127.0;
  vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  n = normalize(n);
  vec4 eye = viewMatrix * p;
  float facing = abs(dot(normalize((viewMatrix * vec4(n, 0.0)).xyz), normalize(eye.xyz + vec3(0.0, -0.35 * length(eye.xyz), 0.0))));
  vec3 colour = mode == 1 ? ramp((height - heights.x) / max(heights.y - heights.x, 1e-6)) : mode == 2 ? vec3(0.12 + 0.86 * intensity) : own;
  shade = mix(colour * (mode == 2 ? 0.75 + 0.25 * facing : 0.45 + 0.6 * facing), faint, dim);
  gl_Position = projectionMatrix * eye;
  gl_PointSize = clamp(size * (1.0 - 0.5 * dim) * voxel * pixels / max(gl_Position.w, 1e-3), 1.0, 24.0);
  gl_Position.z += 0.001 * dim * gl_Position.w;  // what is selected wins over what is not
}`;

const fragmentShader = `
varying vec3 shade;
varying float gone;
void main() {
  if (gone > 0.5) discard;
  gl_FragColor = vec4(shade, 1.0);
  #include <colorspace_fragment>
}`;

/// One draw call; `shared` holds the uniforms that all clouds have in common.
export const cloudOf = (station, shared) => {
  const bytes = bytesOf(station.data);
  const n = station.points;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Uint16Array(bytes.buffer, 0, 3 * n), 3));
  geometry.setAttribute("octahedral", new BufferAttribute(new Int8Array(bytes.buffer, 6 * n, 2 * n), 2));
  const intensity = station.intensity ? new Uint8Array(bytes.buffer, 8 * n, n) : new Uint8Array(n).fill(128);
  geometry.setAttribute("intensity", new BufferAttribute(intensity, 1, true));
  const material = new ShaderMaterial({
    vertexShader, fragmentShader,
    uniforms: { ...shared, own: { value: new Color() }, dim: { value: 0 } },
  });
  const points = new Points(geometry, material);
  points.scale.setScalar(station.step);
  points.position.fromArray(station.low);
  points.frustumCulled = false;
  points.userData = { station, count: n };
  const reach = 65535 * station.step;
  points.userData.low = new Vector3().fromArray(station.low);
  points.userData.high = points.userData.low.clone().addScalar(reach);
  return points;
};
