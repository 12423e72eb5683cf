// Spheres as points of the right size that are shaded like spheres: thousands of them are drawn without a graphics card.
{
	const VERTEX = `
		attribute float radius;
		attribute vec3 tint;
		uniform float scale;
		uniform vec4 cut;
		varying vec3 shade;
		void main() {
			vec4 seen = modelViewMatrix * vec4(position, 1.0);
			gl_Position = projectionMatrix * seen;
			gl_PointSize = 2.0 * radius * scale / -seen.z;
			if (dot(position, cut.xyz) > cut.w) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
			shade = tint;
		}`;
	const FRAGMENT = `
		varying vec3 shade;
		void main() {
			vec2 at = 2.0 * gl_PointCoord - 1.0;
			float square = dot(at, at);
			if (square > 1.0) discard;
			float light = 0.3 + 0.7 * max(0.0, dot(vec3(at.x, -at.y, sqrt(1.0 - square)), vec3(-0.37, 0.55, 0.75)));
			gl_FragColor = vec4(shade * light, 1.0);
		}`;
	const BINS = 2048,
		TURNED = 0.995;

	// Front to back, so that what is hidden is not shaded: one pass over bins of depth.
	function order(position, direction, index) {
		const count = index.length,
			depth = new Float32Array(count),
			starts = new Uint32Array(BINS + 1);
		let low = Infinity,
			high = -Infinity;
		for (let k = 0; k < count; ++k) {
			const d = position[3 * k] * direction.x + position[3 * k + 1] * direction.y + position[3 * k + 2] * direction.z;
			depth[k] = d;
			if (d < low) low = d;
			if (d > high) high = d;
		}
		const scale = (BINS - 1) / (high - low || 1),
			bins = new Uint16Array(count);
		for (let k = 0; k < count; ++k) {
			bins[k] = (depth[k] - low) * scale;
			++starts[bins[k] + 1];
		}
		for (let k = 0; k < BINS; ++k) starts[k + 1] += starts[k];
		for (let k = 0; k < count; ++k) index[starts[bins[k]]++] = k;
	}

	// radii, positions: Float32Array [mm]. cut: {x, y, z, w}, what is beyond x.n > w is left out.
	report.spheres = (count) => {
		const geometry = new THREE.BufferGeometry();
		const attribute = (name, size) => {
			const made = new THREE.BufferAttribute(new Float32Array(count * size), size);
			geometry.setAttribute(name, made);
			return made;
		};
		const position = attribute("position", 3),
			radius = attribute("radius", 1),
			tint = attribute("tint", 3);
		const index = new THREE.BufferAttribute(new Uint32Array(count), 1);
		geometry.setIndex(index);
		const material = new THREE.ShaderMaterial({
			vertexShader: VERTEX,
			fragmentShader: FRAGMENT,
			uniforms: { scale: { value: 1 }, cut: { value: new THREE.Vector4(0, 0, 0, 1) } },
		});
		const points = new THREE.Points(geometry, material);
		points.frustumCulled = false;
		let sorted = null;
		return {
			object: points,
			position,
			radius,
			tint,
			material,
			changed() {
				position.needsUpdate = radius.needsUpdate = tint.needsUpdate = true;
				sorted = null;
			},
			// direction: into the picture
			sort(direction) {
				if (sorted && sorted.dot(direction) > TURNED) return;
				sorted = direction.clone();
				order(position.array, direction, index.array);
				index.needsUpdate = true;
			},
			dispose() {
				geometry.dispose();
				material.dispose();
			},
		};
	};
}
