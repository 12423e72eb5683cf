// Clouds on a vertical section, and profiles along the height, at the state nearest to a strain.
{
	const { element } = report;

	const LETTERS = 21,
		LARGER = 1.25;

	// A text in lines of so many letters at most, broken at spaces.
	const inLines = (text, most) =>
		text.split(" ").reduce((lines, word) => {
			const last = lines[lines.length - 1];
			if (last && last.length + word.length < most) lines[lines.length - 1] = `${last} ${word}`;
			else lines.push(word);
			return lines;
		}, []);

	class Clouds {
		constructor(parent, run) {
			Object.assign(this, { run, data: run.clouds, state: 0 });
			const { figure, caption } = report.figure(parent, "", `${run.name}-clouds`, {
				svg: () => report.alone(this.svg.node()),
				csv: () => this.csv(),
			});
			this.caption = caption;
			const holder = element("div", { class: "clouds", tabindex: 0, "aria-label": "clouds, scrolls sideways" });
			this.svg = d3.create("svg").attr("role", "img");
			holder.append(this.svg.node());
			figure.append(holder);
		}

		async show(strain) {
			this.state = report.nearest(this.data.strains, strain);
			const { data, state, svg } = this,
				grid = data.grids[state],
				wide = 124,
				edge = 46,
				gap = 26,
				top = 46;
			const values = await Promise.all(data.quantities.map((one) => report.array(one.states[state])));
			this.values = values.map((one) => one[0]);
			const [a, z] = [grid.along, grid.height],
				da = a[1] - a[0],
				dz = z[1] - z[0];
			const scale = wide / (a[a.length - 1] - a[0] + da),
				high = scale * (z[z.length - 1] - z[0] + dz);
			svg.selectAll("*").remove();
			svg.attr("viewBox", `0 0 ${edge + data.quantities.length * (wide + gap)} ${top + high + 74}`);
			this.caption.textContent = `Clouds at ${report.told(this.run, data.strains[state])}, section along ${report.number(data.azimuth, 3)}\u00b0 from x`;
			svg.attr(
				"aria-label",
				`${this.caption.textContent}: ${data.quantities.map((one) => `${one.label} ${report.number(one.range[0], 3)} to ${report.number(one.range[1], 3)}`).join(", ")}`,
			);
			data.quantities.forEach((one, k) => {
				const x = edge + k * (wide + gap),
					group = svg.append("g").attr("transform", `translate(${x},${top})`);
				inLines(one.label.replace(" [-]", ""), LETTERS)
					.reverse()
					.forEach((text, line) =>
						group
							.append("text")
							.attr("x", wide / 2)
							.attr("y", -7 - 13 * line)
							.attr("text-anchor", "middle")
							.text(text),
					);
				group
					.append("image")
					.attr("width", wide)
					.attr("height", high)
					.attr("preserveAspectRatio", "none")
					.attr("href", picture(this.values[k], a.length, z.length, report.scale(one.colours, one.range)));
				group.append("rect").attr("class", "frame").attr("width", wide).attr("height", high);
				const across = d3
						.scaleLinear()
						.domain([a[0] - da / 2, a[a.length - 1] + da / 2])
						.range([0, wide]),
					up = d3
						.scaleLinear()
						.domain([z[0] - dz / 2, z[z.length - 1] + dz / 2])
						.range([high, 0]);
				group.append("g").attr("class", "axis").attr("transform", `translate(0,${high})`).call(d3.axisBottom(across).ticks(3));
				if (k === 0) group.append("g").attr("class", "axis").call(d3.axisLeft(up).ticks(6));
				report.bar(group, 4, high + 48, wide - 8, one.colours, one.range, null);
				group
					.append("text")
					.attr("x", wide / 2)
					.attr("y", high + 32)
					.attr("text-anchor", "middle")
					.text("along [mm]");
			});
			svg.append("text")
				.attr("transform", `translate(10,${top + high / 2}) rotate(-90)`)
				.attr("text-anchor", "middle")
				.text("height [mm]");
		}

		csv() {
			const { along, height } = this.data.grids[this.state];
			const rows = height.flatMap((z, i) => along.map((x, j) => [x, z, ...this.values.map((one) => one[i * along.length + j])]));
			return report.csv(["along [mm]", "height [mm]", ...this.data.quantities.map((one) => one.label)], rows);
		}
	}

	// The values of a grid, first row at the bottom, as the address of a picture.
	function picture(values, width, height, colour) {
		const canvas = element("canvas", { width, height }),
			context = canvas.getContext("2d"),
			image = context.createImageData(width, height);
		for (let row = 0; row < height; ++row) {
			for (let k = 0; k < width; ++k) {
				const value = values[row * width + k];
				if (!Number.isNaN(value)) image.data.set([...colour(value), 255], 4 * ((height - 1 - row) * width + k));
			}
		}
		context.putImageData(image, 0, 0);
		return canvas.toDataURL();
	}

	class Profile {
		constructor(parent, run) {
			Object.assign(this, { run, data: run.profile, state: 0 });
			const { figure, caption } = report.figure(parent, "", `${run.name}-profile`, {
				svg: () => report.alone(this.svg.node()),
				csv: () => this.csv(),
			});
			this.caption = caption;
			this.svg = d3.create("svg").attr("role", "img");
			figure.append(this.svg.node());
		}

		show(strain) {
			this.state = report.nearest(this.data.strains, strain);
			const { data, state, svg } = this;
			const panels = [{ label: "radius [mm]", lines: [["radius", "", "none"]] }];
			if (data.axial)
				panels.push({
					label: "stress of the soil [kPa]",
					lines: [
						["axial", "axial", "none"],
						["radial", "radial", "6 3"],
					],
				});
			const wide = 190,
				high = 230,
				edge = 48,
				gap = 34;
			svg.selectAll("*").remove();
			svg.attr("viewBox", `0 0 ${edge + panels.length * (wide + gap)} ${high + 52}`).style(
				"max-width",
				`${LARGER * (edge + panels.length * (wide + gap))}px`,
			);
			this.caption.textContent = `Along the height at ${report.told(this.run, data.strains[state])} (solid) and at the start (dotted); ${data.from}`;
			svg.attr("aria-label", this.caption.textContent);
			const up = d3
				.scaleLinear()
				.domain([0, d3.max(data.height.flat())])
				.nice()
				.range([high, 16]);
			panels.forEach((panel, k) => {
				const group = svg.append("g").attr("transform", `translate(${edge + k * (wide + gap)},0)`);
				const [low, most] = d3.extent(panel.lines.flatMap(([name]) => data[name].flat()).filter((one) => one !== null));
				const edgeOf = (most - low) * 0.05 || 1,
					across = d3
						.scaleLinear()
						.domain([low - edgeOf, most + edgeOf])
						.range([0, wide]);
				const line = (name, at) =>
					d3
						.line()
						.defined((p) => p[0] !== null && p[1] !== null)
						.x((p) => across(p[0]))
						.y((p) => up(p[1]))(d3.zip(data[name][at], data.height[at]));
				group
					.selectAll("line")
					.data(across.ticks(4))
					.join("line")
					.attr("class", "grid")
					.attr("x1", across)
					.attr("x2", across)
					.attr("y1", 16)
					.attr("y2", high);
				group.append("g").attr("class", "axis").attr("transform", `translate(0,${high})`).call(d3.axisBottom(across).ticks(4));
				group.append("g").attr("class", "axis").call(d3.axisLeft(up).ticks(6));
				panel.lines.forEach(([name, text, dash], i) => {
					group
						.append("path")
						.attr("class", "curve")
						.attr("d", line(name, 0))
						.style("stroke", `var(--line${i})`)
						.attr("stroke-width", 1.2)
						.attr("stroke-dasharray", "1.5 3");
					group
						.append("path")
						.attr("class", "curve")
						.attr("d", line(name, state))
						.style("stroke", `var(--line${i})`)
						.attr("stroke-width", 2)
						.attr("stroke-dasharray", dash);
					if (!text) return;
					const key = group
						.append("g")
						.attr("transform", `translate(${wide - 64 + 70 * (i - 1)},4)`)
						.style("fill", `var(--line${i})`);
					key.append("line").attr("x2", 26).style("stroke", `var(--line${i})`).attr("stroke-width", 2).attr("stroke-dasharray", dash);
					key.append("text").attr("x", 30).attr("y", 4).style("fill", `var(--line${i})`).attr("font-weight", 700).text(text);
				});
				group
					.append("text")
					.attr("x", wide / 2)
					.attr("y", high + 36)
					.attr("text-anchor", "middle")
					.text(panel.label);
			});
			svg.append("text")
				.attr("transform", `translate(11,${high / 2}) rotate(-90)`)
				.attr("text-anchor", "middle")
				.text("height [mm]");
		}

		csv() {
			const { data } = this,
				names = ["height", "radius", "axial", "radial"].filter((name) => data[name]);
			const units = { height: "mm", radius: "mm", axial: "kPa", radial: "kPa" };
			const rows = data.strains.flatMap((strain, k) => data.height[k].map((_, i) => [strain, ...names.map((name) => data[name][k][i])]));
			return report.csv([this.run.stages ? "time [s]" : "axial_strain [-]", ...names.map((name) => `${name} [${units[name]}]`)], rows);
		}
	}
	Object.assign(report, { Clouds, Profile });
}
