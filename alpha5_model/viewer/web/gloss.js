// Light on the bodies at their vertices, highlights included [Gouraud1971]. meshcat's light at every pixel took twice as
// long where no graphics card draws; the bodies have vertices enough that both look alike.
const HIGHLIGHT = "vShine += saturate( dotNL ) * directLight.color * BRDF_BlinnPhong( directLight, geometry, specular, shininess );";

// A material that looks like one of three's Phong materials.
function litAtVertices(phong) {
  const material = new THREE.MeshLambertMaterial().copy(phong);
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { specular: { value: phong.specular }, shininess: { value: phong.shininess } });
    const lights = THREE.ShaderChunk.lights_lambert_vertex.replaceAll("vLightFront += saturate", `${HIGHLIGHT}\nvLightFront += saturate`);
    shader.vertexShader = shader.vertexShader
      .replace("void main", "uniform vec3 specular; uniform float shininess; varying vec3 vShine;\nvoid main")
      .replace("#include <lights_lambert_vertex>", `vShine = vec3( 0.0 );\n${lights}`);
    shader.fragmentShader = shader.fragmentShader
      .replace("void main", "varying vec3 vShine;\nvoid main")
      .replace("+ totalEmissiveRadiance", "+ vShine + totalEmissiveRadiance");
  };
  return material;
}
