// The lateral boundary: triangles with a colour a point, of which those are drawn that are behind the specimen's axis or before the cut.
{
	const VERTEX = `
		attribute vec3 tint;
		varying vec3 shade;
		void main() {
			vec4 seen = modelViewMatrix * vec4(position, 1.0);
			gl_Position = projectionMatrix * seen;
			vec3 face = normalize(normalMatrix * normal);
			if (dot(face, seen.xyz) > 0.0) face = -face;
			shade = tint * (0.6 + 0.4 * max(0.0, dot(face, vec3(-0.37, 0.55, 0.75))));
		}`;
	const FRAGMENT = `
		uniform float opacity;
		varying vec3 shade;
		void main() {
			gl_FragColor = vec4(shade, opacity);
		}`;

	class Sheet {
		// count: of points; triangles: Uint32Array.
		constructor(count, triangles) {
			const geometry = (this.geometry = new THREE.BufferGeometry());
			for (const name of ["position", "normal", "tint"]) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3));
			Object.assign(this, { triangles, behind: new Uint8Array(count), ...geometry.attributes });
			geometry.setIndex(new THREE.BufferAttribute(triangles.slice(), 1));
			this.material = new THREE.ShaderMaterial({
				vertexShader: VERTEX,
				fragmentShader: FRAGMENT,
				side: THREE.DoubleSide,
				uniforms: { opacity: { value: 1 } },
			});
			this.object = new THREE.Mesh(geometry, this.material);
			this.object.frustumCulled = false;
			this.object.renderOrder = 1; // most of it is behind grains: they come first
		}

		// Positions and colours are new.
		changed() {
			const { geometry, triangles, position, tint } = this;
			geometry.index.array.set(triangles);
			geometry.computeVertexNormals();
			position.needsUpdate = tint.needsUpdate = true;
		}

		set glass(on) {
			this.material.uniforms.opacity.value = on ? 0.4 : 1;
			Object.assign(this.material, { transparent: on, depthWrite: !on });
		}

		// Draw the triangles that have a point on no plane's far side; planes: {normal, far}.
		see(planes) {
			const { triangles, behind, geometry } = this,
				at = this.position.array,
				index = geometry.index;
			behind.fill(0);
			for (const { normal, far } of planes)
				for (let k = 0; k < behind.length; ++k)
					if (normal.x * at[3 * k] + normal.y * at[3 * k + 1] + normal.z * at[3 * k + 2] > far) behind[k] = 1;
			let kept = 0;
			for (let k = 0; k < triangles.length; k += 3) {
				if (behind[triangles[k]] + behind[triangles[k + 1]] + behind[triangles[k + 2]] > 1) continue;
				for (let i = 0; i < 3; ++i) index.array[kept++] = triangles[k + i];
			}
			geometry.setDrawRange(0, kept);
			index.updateRange.count = kept;
			index.needsUpdate = true;
		}

		dispose() {
			this.geometry.dispose();
			this.material.dispose();
		}
	}
	report.Sheet = Sheet;
}
