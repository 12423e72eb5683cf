// Spheres as points of the right size that are shaded like spheres: thousands of them are drawn without a graphics card.
{
	const VERTEX = `
		attribute float radius;
		attribute vec3 tint;
		uniform float scale;
		varying vec3 shade;
		void main() {
			vec4 seen = modelViewMatrix * vec4(position, 1.0);
			gl_Position = projectionMatrix * seen;
			gl_PointSize = 2.0 * radius * scale / -seen.z;
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
	const BINS = 2048;

	// Which spheres are seen, front to back: a sphere of which each cell of the picture is within nearer ones is left out.
	class Seen {
		constructor(count) {
			Object.assign(this, { depth: new Float32Array(count), bins: new Uint16Array(count), order: new Uint32Array(count) });
			this.cells = new Uint8Array(0);
		}

		// Distances from the reader, and the order by them of those that are before him and beyond no plane; returns their number.
		sort(position, view, planes) {
			const { depth, bins, order } = this,
				starts = new Uint32Array(BINS + 2);
			let low = Infinity,
				high = -Infinity;
			for (let k = 0; k < depth.length; ++k) {
				const x = position[3 * k],
					y = position[3 * k + 1],
					z = position[3 * k + 2];
				let d = -(view[2] * x + view[6] * y + view[10] * z + view[14]);
				for (const { normal, far } of planes) if (normal.x * x + normal.y * y + normal.z * z > far) d = -1;
				depth[k] = d;
				if (d <= 0) continue;
				if (d < low) low = d;
				if (d > high) high = d;
			}
			const scale = (BINS - 1) / (high - low || 1);
			for (let k = 0; k < depth.length; ++k) {
				bins[k] = depth[k] > 0 ? (depth[k] - low) * scale : BINS;
				++starts[bins[k] + 1];
			}
			const count = depth.length - starts[BINS + 1];
			for (let k = 0; k < BINS; ++k) starts[k + 1] += starts[k];
			for (let k = 0; k < depth.length; ++k) if (bins[k] < BINS) order[starts[bins[k]]++] = k;
			return count;
		}

		// Writes the numbers of those that are seen to index, returns how many. wide, high: of the picture in cells; focal: as in it.
		fill(index, position, radius, view, planes, wide, high, focal) {
			const { depth, order } = this,
				count = this.sort(position, view, planes);
			if (this.cells.length !== wide * high) this.cells = new Uint8Array(wide * high);
			else this.cells.fill(0);
			let kept = 0;
			for (let i = 0; i < count; ++i) {
				const k = order[i],
					x = position[3 * k],
					y = position[3 * k + 1],
					z = position[3 * k + 2],
					scale = focal / depth[k];
				const u = wide / 2 + scale * (view[0] * x + view[4] * y + view[8] * z + view[12]),
					v = high / 2 - scale * (view[1] * x + view[5] * y + view[9] * z + view[13]);
				if (this.open(u, v, scale * radius[k], wide, high)) index[kept++] = k;
			}
			return kept;
		}

		// Whether a disc touches a cell that is not covered; it covers those that lie in it.
		open(u, v, r, wide, high) {
			const { cells } = this,
				first = Math.max(0, Math.floor(v - r)),
				last = Math.min(high - 1, Math.floor(v + r));
			let found = false;
			for (let row = first; row <= last && !found; ++row) {
				const near = Math.max(0, row - v, v - row - 1),
					half = Math.sqrt(Math.max(0, r * r - near * near)),
					end = Math.min(wide - 1, Math.floor(u + half)) + row * wide;
				for (let at = Math.max(0, Math.floor(u - half)) + row * wide; at <= end && !found; ++at) found = cells[at] === 0;
			}
			if (!found) return false;
			for (let row = first; row <= last; ++row) {
				const away = Math.max(v - row, row + 1 - v);
				if (away >= r) continue;
				const half = Math.sqrt(r * r - away * away),
					from = Math.max(0, Math.ceil(u - half)),
					to = Math.min(wide, Math.floor(u + half));
				if (to > from) cells.fill(1, from + row * wide, to + row * wide);
			}
			return true;
		}
	}

	// position, radius: Float32Array [mm].
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
		const material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { scale: { value: 1 } } });
		const points = new THREE.Points(geometry, material),
			seen = new Seen(count);
		points.frustumCulled = false;
		return {
			object: points,
			position,
			radius,
			tint,
			changed() {
				position.needsUpdate = radius.needsUpdate = tint.needsUpdate = true;
			},
			// camera: its matrices are those of the picture. wide, high: of the picture [pixels of the page]; ratio: pixels drawn of one of these.
			// planes: {normal, far} each, spheres beyond one are left out.
			see(camera, planes, wide, high, ratio) {
				const focal = (camera.projectionMatrix.elements[5] * high) / 2;
				material.uniforms.scale.value = ratio * focal;
				const kept = seen.fill(index.array, position.array, radius.array, camera.matrixWorldInverse.elements, planes, wide, high, focal);
				geometry.setDrawRange(0, kept);
				index.updateRange.count = kept;
				index.needsUpdate = true;
			},
			dispose() {
				geometry.dispose();
				material.dispose();
			},
		};
	};
}
