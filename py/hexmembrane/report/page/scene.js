// The specimen in space: grains, lateral boundary, bands; turned by mouse, touch or keys, drawn only when something changes.
{
	const MM = 1000,
		FIELD = 30,
		SLOW = 36,
		LEAST = 0.35,
		TURN = 0.09,
		CHAINS = "plasma";
	const { element } = report;
	const WANTED = { grains: "", boundary: "", sheet: "back", cut: false, depth: 0, azimuth: 0, top: false, level: 50, bands: true, chains: false, share: 20 };

	class Scene {
		// before: what view() gave.
		constructor(parent, run, before) {
			Object.assign(this, { run, data: run.scene, frame: 0, options: { ...WANTED }, ratio: 1, moved: 0 });
			const { data } = this;
			this.options.grains = (data.grains.quantities.find((one) => one.name === "shear") ?? data.grains.quantities[0])?.name ?? "";
			this.options.boundary = data.boundary?.quantities[0]?.name ?? "";
			const { figure, caption } = report.figure(parent, "Grains and lateral boundary", `${run.name}-scene`, {
				svg: () => this.svg(),
				csv: () => this.csv(),
			});
			this.figure = figure;
			Object.assign(this.options, before?.options);
			this.before = before;
			this.caption = caption;
			figure.append(report.tools(data, this.options, { fill: () => this.fill(), look: (direction) => this.look(direction) }));
			this.stage = element("div", {
				class: "stage",
				tabindex: 0,
				role: "application",
				"aria-label": "The specimen in space. Arrow keys turn it, + and - bring it nearer and farther.",
			});
			this.bars = element("div", { class: "bars" });
			this.told = element("output", { class: "readout" });
			figure.append(this.stage, this.bars, this.told);
			this.begin();
		}

		begin() {
			try {
				this.renderer = new THREE.WebGLRenderer({ antialias: false, alpha: true, preserveDrawingBuffer: true });
			} catch (error) {
				this.stage.replaceWith(
					element(
						"p",
						{ class: "problem" },
						"This browser draws no scenes (WebGL is not there or switched off). All else of the page works.",
					),
				);
				return;
			}
			this.stage.append(this.renderer.domElement);
			this.scene = new THREE.Scene();
			this.camera = new THREE.PerspectiveCamera(FIELD, 1, 1, 5000);
			this.camera.up.set(0, 0, 1);
			this.controls = new THREE.OrbitControls(this.camera, this.stage);
			this.controls.enableKeys = false;
			this.controls.addEventListener("change", () => this.move());
			this.stage.addEventListener("keydown", (event) => this.key(event));
			new ResizeObserver(() => this.resize()).observe(this.stage);
			this.ready = this.load();
		}

		async load() {
			const { data } = this;
			this.radii = (await report.array(data.grains.radius))[0];
			this.positions = await report.array(data.grains.position);
			this.spheres = report.spheres(this.radii.length);
			this.spheres.radius.array.set(this.radii.map((one) => MM * one));
			this.scene.add(this.spheres.object);
			if (data.boundary) {
				this.sheetPositions = await report.array(data.boundary.position);
				this.sheet = new report.Sheet(data.boundary.position.shape[1], await report.array(data.boundary.triangles));
				this.scene.add(this.sheet.object);
			}
			if (data.chains) {
				this.chains = new report.Chains(data.chains, d3.mean(this.radii));
				this.scene.add(this.chains.object);
			}
			this.planes = new THREE.Group();
			this.scene.add(this.planes);
			const box = new THREE.Box3();
			for (const places of [this.positions, this.sheetPositions ?? []])
				if (places[0]) box.union(new THREE.Box3().setFromArray(places[0].map((one) => MM * one)));
			this.centre = box.getCenter(new THREE.Vector3());
			this.size = box.getSize(new THREE.Vector3());
			this.look([0.45, -1, 0.28]);
			if (this.before) {
				this.camera.position.fromArray(this.before.camera);
				this.controls.target.fromArray(this.before.target);
				this.controls.update();
			}
			await this.fill();
		}

		// Look from a direction at all of it.
		look(direction) {
			if (!this.centre) return;
			const high = this.size.z / 2,
				wide = Math.hypot(this.size.x, this.size.y) / 2;
			const far = (1.08 * Math.max(high, wide / Math.max(this.camera.aspect, 0.2))) / Math.tan((FIELD * Math.PI) / 360) + wide;
			this.camera.position.copy(new THREE.Vector3(...direction).normalize().multiplyScalar(far).add(this.centre));
			this.controls.target.copy(this.centre);
			this.controls.update();
			this.draw();
		}

		// What the reader has chosen, for a page that is loaded anew; nothing before it is drawn.
		view() {
			if (!this.centre) return null;
			return { options: this.options, camera: this.camera.position.toArray(), target: this.controls.target.toArray() };
		}

		key(event) {
			const turn = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, -TURN], ArrowDown: [0, TURN] }[event.key];
			const nearer = { "+": 1 / 1.1, "=": 1 / 1.1, "-": 1.1 }[event.key];
			if (!turn && !nearer) return;
			event.preventDefault();
			const arm = new THREE.Spherical().setFromVector3(
				this.camera.position
					.clone()
					.sub(this.centre)
					.applyAxisAngle(new THREE.Vector3(1, 0, 0), -Math.PI / 2),
			);
			if (turn) {
				arm.theta += turn[0];
				arm.phi = Math.max(0.02, Math.min(Math.PI - 0.02, arm.phi + turn[1]));
			}
			if (nearer) arm.radius *= nearer;
			this.camera.position
				.setFromSpherical(arm)
				.applyAxisAngle(new THREE.Vector3(1, 0, 0), Math.PI / 2)
				.add(this.centre);
			this.controls.update();
			this.move();
		}

		// The nearest frame to a strain [-].
		async show(strain) {
			this.frame = report.nearest(this.data.strains, strain);
			await this.ready;
			await this.fill();
		}

		quantity(what) {
			return this.data[what]?.quantities.find((one) => one.name === this.options[what]);
		}

		async fill() {
			if (!this.spheres) return;
			const { frame, options } = this,
				wanted = (this.wanted = {});
			const [grains, sheet] = [this.quantity("grains"), this.quantity("boundary")];
			const [values, sheetValues] = [grains && (await report.array(grains.values))[frame], sheet && (await report.array(sheet.values))[frame]];
			const carried = options.chains ? await this.chains.fill(frame, options.share, CHAINS) : "";
			if (wanted !== this.wanted) return; // another was asked for meanwhile
			this.told.textContent = carried;
			Object.assign(this, { values, sheetValues });
			this.place(this.spheres.position.array, this.positions[frame]);
			this.paint(this.spheres.tint.array, values, grains);
			this.spheres.object.visible = options.grains !== "none";
			this.spheres.changed();
			const angle = (options.azimuth * Math.PI) / 180,
				normal = new THREE.Vector3(Math.cos(angle), Math.sin(angle), 0);
			this.cuts = [
				...(options.cut ? [{ normal, far: normal.dot(this.centre) + (options.depth / 100) * (this.size.x / 2) }] : []),
				...(options.top ? [{ normal: this.camera.up, far: this.centre.z + (options.level / 100 - 0.5) * this.size.z }] : []),
			];
			if (this.chains) {
				this.chains.object.visible = options.chains;
				this.chains.cut(this.cuts);
			}
			if (this.sheet) {
				this.place(this.sheet.position.array, this.sheetPositions[frame]);
				this.paint(this.sheet.tint.array, sheetValues, sheet);
				this.sheet.changed();
				this.sheet.object.visible = options.sheet !== "none";
				this.sheet.glass = options.sheet === "glass";
			}
			this.fillPlanes();
			this.describe(grains, sheet);
			this.draw();
		}

		place(to, from) {
			for (let k = 0; k < to.length; ++k) to[k] = MM * from[k];
		}

		paint(to, values, quantity) {
			const colour = quantity ? report.scale(this.map(quantity), quantity.range) : () => [150, 150, 150];
			for (let k = 0; 3 * k < to.length; ++k) {
				const one = colour(values ? values[k] : NaN);
				for (let i = 0; i < 3; ++i) to[3 * k + i] = one[i] / 255;
			}
		}

		map(quantity) {
			return quantity.signed ? "RdBu_r" : "viridis";
		}

		// Planes of the first step with bands that ends at this strain or later.
		fillPlanes() {
			while (this.planes.children.length) this.planes.remove(this.planes.children[0]);
			const strain = this.data.strains[this.frame],
				ends = this.data.planes.map((one) => one.strain).filter((one) => one >= strain - 1e-4);
			if (!this.options.bands || !ends.length) return;
			const end = Math.min(...ends),
				width = 1.5 * Math.max(this.size.x, this.size.y);
			for (const plane of this.data.planes.filter((one) => one.strain === end)) {
				const [dip, azimuth] = [plane.dip, plane.azimuth].map((one) => (one * Math.PI) / 180);
				const shape = new THREE.PlaneBufferGeometry(width, width);
				const face = new THREE.Mesh(
					shape,
					new THREE.MeshBasicMaterial({ color: 0xff8c00, transparent: true, opacity: 0.3, side: THREE.DoubleSide, depthWrite: false }),
				);
				face.add(new THREE.LineSegments(new THREE.EdgesGeometry(shape), new THREE.LineBasicMaterial({ color: 0xff8c00 })));
				face.quaternion.setFromUnitVectors(
					new THREE.Vector3(0, 0, 1),
					new THREE.Vector3(Math.sin(dip) * Math.cos(azimuth), Math.sin(dip) * Math.sin(azimuth), Math.cos(dip)),
				);
				face.position.set(0, 0, MM * (this.data.bottom[this.frame] + plane.height));
				this.planes.add(face);
			}
		}

		describe(grains, sheet) {
			this.caption.textContent = `${this.run.title}: grains and lateral boundary at ${report.told(this.run, this.data.strains[this.frame])}`;
			const { options } = this,
				named = (one) => one.label + (one.unit ? ` [${one.unit}]` : "");
			this.shown = [
				["grains", grains],
				["boundary", options.sheet === "none" ? null : sheet],
			]
				.filter((one) => one[1])
				.map(([who, one]) => [`${who}: ${named(one)}`, this.map(one), one.range]);
			if (options.chains) this.shown.push(["contacts: normal force over its mean", CHAINS, this.chains.range]);
			this.bars.replaceChildren(
				...this.shown.map(([label, map, range]) => {
					const svg = d3
						.create("svg")
						.attr("viewBox", "0 0 240 44")
						.attr("role", "img")
						.attr("aria-label", `${label}, from ${report.number(range[0])} to ${report.number(range[1])}`);
					report.bar(svg, 2, 17, 230, map, range, label);
					return svg.node();
				}),
			);
		}

		resize() {
			const { clientWidth, clientHeight } = this.stage;
			if (!clientWidth || !clientHeight) return;
			this.camera.aspect = clientWidth / clientHeight;
			this.camera.updateProjectionMatrix();
			this.setRatio(this.ratio);
			this.draw();
		}

		setRatio(ratio) {
			this.ratio = ratio;
			this.renderer.setPixelRatio(ratio * Math.min(window.devicePixelRatio || 1, 2));
			this.renderer.setSize(this.stage.clientWidth, this.stage.clientHeight, false);
		}

		// Draw while it is turned: coarser when the browser is slow, fine again at rest.
		move() {
			const now = performance.now(),
				since = now - this.moved;
			this.moved = now;
			if (since > SLOW && since < 500 && this.ratio > LEAST) this.setRatio(Math.max(LEAST, 0.8 * this.ratio));
			clearTimeout(this.rest);
			this.rest = setTimeout(() => {
				if (this.ratio < 1) {
					this.setRatio(1);
					this.draw();
				}
			}, 300);
			this.draw();
		}

		draw() {
			this.pending ??= requestAnimationFrame(() => {
				this.pending = undefined;
				this.render();
			});
		}

		render() {
			const { clientWidth, clientHeight } = this.stage;
			if (!this.cuts || !clientWidth || !clientHeight) return;
			const direction = this.camera.getWorldDirection(new THREE.Vector3());
			this.camera.updateMatrixWorld();
			if (this.spheres.object.visible) this.spheres.see(this.camera, this.cuts, clientWidth, clientHeight, this.renderer.getPixelRatio());
			if (this.sheet?.object.visible) {
				const planes = [...this.cuts],
					away = new THREE.Vector3(-direction.x, -direction.y, 0);
				if (this.options.sheet === "back" && away.lengthSq() > 1e-6) planes.push({ normal: away, far: away.dot(this.centre) });
				this.sheet.see(planes);
			}
			this.renderer.render(this.scene, this.camera);
		}

		// Pictures a second while it is turned, over a number of them, as fine as setRatio() has it.
		async measure(pictures) {
			await this.ready;
			const arm = new THREE.Vector3(),
				axis = new THREE.Vector3(0, 0, 1),
				gl = this.renderer.getContext(),
				{ target } = this.controls;
			return new Promise((resolve) => {
				let left = pictures;
				const start = performance.now();
				const next = () => {
					if (left-- === 0) {
						gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until all are drawn
						resolve((1000 * pictures) / (performance.now() - start));
						return;
					}
					this.camera.position.copy(arm.copy(this.camera.position).sub(target).applyAxisAngle(axis, TURN).add(target));
					this.camera.lookAt(target);
					this.render();
					requestAnimationFrame(next);
				};
				next();
			});
		}

		svg() {
			this.render();
			const { width, height } = this.renderer.domElement,
				svg = d3.create("svg").attr("viewBox", `0 0 640 ${(640 * height) / width + 70}`);
			svg.append("text").attr("x", 8).attr("y", 16).text(this.caption.textContent);
			svg.append("image")
				.attr("y", 24)
				.attr("width", 640)
				.attr("height", (640 * height) / width)
				.attr("href", this.renderer.domElement.toDataURL());
			this.shown.forEach(([label, map, range], k) => report.bar(svg, 8 + 212 * k, (640 * height) / width + 44, 196, map, range, label));
			this.figure.append(svg.node());
			const text = report.alone(svg.node());
			svg.remove();
			return text;
		}

		// Of the contacts where they are drawn without the grains, else of the grains and the boundary that is drawn.
		csv() {
			if (this.options.chains && this.options.grains === "none") return this.chains.csv();
			const { frame, options } = this;
			const bodies = [{ who: "grain", at: this.positions[frame], radii: this.radii, quantity: this.quantity("grains"), values: this.values }];
			if (this.sheet && options.sheet !== "none")
				bodies.push({ who: "boundary", at: this.sheetPositions[frame], quantity: this.quantity("boundary"), values: this.sheetValues });
			const coloured = bodies.filter((one) => one.quantity);
			const rows = bodies.flatMap((one) =>
				Array.from({ length: one.at.length / 3 }, (_, k) => [
					one.who,
					...one.at.subarray(3 * k, 3 * k + 3),
					one.radii?.[k],
					...coloured.map((other) => (other === one ? one.values[k] : null)),
				]),
			);
			const named = ({ who, quantity }) => `${who}: ${quantity.label}${quantity.unit ? ` [${quantity.unit}]` : ""}`;
			return report.csv(["body", "x [m]", "y [m]", "z [m]", "radius [m]", ...coloured.map(named)], rows);
		}

		dispose() {
			cancelAnimationFrame(this.pending);
			clearTimeout(this.rest);
			this.spheres?.dispose();
			this.chains?.dispose();
			this.sheet?.dispose();
			this.renderer?.dispose();
			this.renderer?.forceContextLoss();
		}
	}
	report.Scene = Scene;
}
