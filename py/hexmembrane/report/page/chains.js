// Force chains: contacts as tubes, drawn as flat strips that face the reader and are shaded like cylinders.
{
	const VERTEX = `
		attribute vec3 start;
		attribute vec3 end;
		attribute float radius;
		attribute vec3 tint;
		uniform vec4 cuts[2];
		varying vec3 shade;
		varying float across;
		void main() {
			vec3 a = (modelViewMatrix * vec4(start, 1.0)).xyz, b = (modelViewMatrix * vec4(end, 1.0)).xyz;
			vec3 at = mix(a, b, position.x), side = cross(b - a, at);
			float size = length(side);
			gl_Position = projectionMatrix * vec4(at + (size > 0.0 ? position.y * radius / size : 0.0) * side, 1.0);
			for (int k = 0; k < 2; ++k)
				if (dot(0.5 * (start + end), cuts[k].xyz) > cuts[k].w) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
			shade = tint;
			across = position.y;
		}`;
	const FRAGMENT = `
		varying vec3 shade;
		varying float across;
		void main() {
			gl_FragColor = vec4(shade * (0.35 + 0.65 * sqrt(max(0.0, 1.0 - across * across))), 1.0);
		}`;
	// A contact with the mean force has a tube of this share of the mean grain's radius; from this many times the mean on all are the same.
	const THICK = 0.1,
		MOST = 6;
	const MM = 1000,
		CORNERS = 4;

	class Chains {
		// frames: as hexmembrane/report/chains.py writes them; radius: of the mean grain [m].
		constructor(frames, radius) {
			Object.assign(this, { frames, thick: MM * THICK * radius, range: [0, MOST] });
			const most = Math.max(...frames.map((one) => one.ends.shape[1])),
				geometry = (this.geometry = new THREE.BufferGeometry());
			// four corners a contact, not instances: a processor draws each instance as a picture of its own
			const corners = new Float32Array(3 * CORNERS * most),
				index = new Uint32Array(6 * most);
			for (let k = 0; k < most; ++k) {
				corners.set([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0], 3 * CORNERS * k);
				index.set(
					[0, 1, 2, 0, 2, 3].map((one) => CORNERS * k + one),
					6 * k,
				);
			}
			geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
			geometry.setIndex(new THREE.BufferAttribute(index, 1));
			for (const [name, size] of [
				["start", 3],
				["end", 3],
				["radius", 1],
				["tint", 3],
			])
				geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(CORNERS * size * most), size));
			this.material = new THREE.ShaderMaterial({
				vertexShader: VERTEX,
				fragmentShader: FRAGMENT,
				side: THREE.DoubleSide,
				uniforms: { cuts: { value: [new THREE.Vector4(), new THREE.Vector4()] } },
			});
			this.object = new THREE.Mesh(geometry, this.material);
			this.object.frustumCulled = false;
			this.object.visible = false;
		}

		// A frame's strongest contacts; share: of all of them, in percent.
		async fill(frame, share, map) {
			const { geometry, thick } = this,
				one = this.frames[frame];
			const [ends, force] = (await Promise.all([report.array(one.ends), report.array(one.force)])).map((values) => values[0]);
			if (this.frame !== frame) {
				const { start, end, radius, tint } = geometry.attributes,
					colour = report.scale(map, this.range);
				for (let at = 0; at < CORNERS * force.length; ++at) {
					const k = Math.floor(at / CORNERS),
						shade = colour(force[k]);
					for (let i = 0; i < 3; ++i) {
						start.array[3 * at + i] = MM * ends[6 * k + i];
						end.array[3 * at + i] = MM * ends[6 * k + 3 + i];
						tint.array[3 * at + i] = shade[i] / 255;
					}
					radius.array[at] = thick * Math.min(MOST, force[k]);
				}
				start.needsUpdate = end.needsUpdate = radius.needsUpdate = tint.needsUpdate = true;
				Object.assign(this, { frame, ends, force });
			}
			this.count = Math.min(force.length, Math.round((share / 100) * one.all));
			geometry.setDrawRange(0, 6 * this.count);
			const carried = force.subarray(0, this.count).reduce((sum, each) => sum + each, 0) / one.all;
			return `The ${this.count} strongest of ${one.all} contacts carry ${report.number(100 * carried, 3)} % of the normal forces, whose mean is ${report.number(one.mean, 3)} N.`;
		}

		// Leave out contacts whose middle is beyond one of two planes, {normal, far}, at most.
		cut(planes) {
			this.material.uniforms.cuts.value.forEach((one, k) => (planes[k] ? one.set(...planes[k].normal.toArray(), planes[k].far) : one.set(0, 0, 0, 1)));
		}

		csv() {
			const header = ["x1 [m]", "y1 [m]", "z1 [m]", "x2 [m]", "y2 [m]", "z2 [m]", "normal force [N]"],
				{ mean } = this.frames[this.frame];
			return report.csv(
				header,
				Array.from({ length: this.count }, (_, k) => [...this.ends.subarray(6 * k, 6 * k + 6), mean * this.force[k]]),
			);
		}

		dispose() {
			this.geometry.dispose();
			this.material.dispose();
		}
	}
	report.Chains = Chains;
}
