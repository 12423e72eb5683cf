// The page's content: JSON in the page, its arrays as hexmembrane/report/encode.py writes them.
"use strict";
const report = { content: JSON.parse(document.getElementById("data").textContent) };
{
	const NAN = 65535,
		SETTLING = 1e-6; // strains below this are told as 0

	async function bytes(text) {
		const packed = Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
		const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
		return new Uint8Array(await new Response(stream).arrayBuffer());
	}

	async function decode(encoded) {
		const raw = await bytes(encoded.data);
		if (encoded.low === undefined) return new Uint32Array(raw.buffer);
		const [frames, ...rest] = encoded.shape;
		const size = rest.reduce((a, b) => a * b, 1),
			count = frames * size,
			scale = (encoded.high - encoded.low) / (NAN - 1);
		const codes = new Uint16Array(size),
			found = [];
		for (let frame = 0; frame < frames; ++frame) {
			const values = new Float32Array(size);
			for (let k = 0, at = frame * size; k < size; ++k, ++at) {
				codes[k] += raw[at] | (raw[count + at] << 8); // whole numbers of 16 bits turn round at the end
				values[k] = codes[k] === NAN ? NaN : encoded.low + codes[k] * scale;
			}
			found.push(values);
		}
		return found;
	}

	// A list of frames, each a Float32Array; whole numbers: one Uint32Array. Decoded once.
	report.array = (encoded) => (encoded.decoded ??= decode(encoded));

	// A fault of the page itself is told on the page too.
	const failed = (reason) => {
		const section = document.getElementById("problems");
		section.hidden = false;
		section.querySelector("ul").append(report.element("li", {}, `This page could not draw a part of it: ${reason?.message ?? reason}`));
	};
	addEventListener("error", (event) => failed(event.error ?? event.message));
	addEventListener("unhandledrejection", (event) => failed(event.reason));

	// What tells a test from the others, its title where nothing else does.
	report.label = (run) => run.label || (run.title === run.name ? "" : run.title);

	// Index of the value that is nearest; of equally near ones the first.
	report.nearest = (values, wanted) =>
		values.reduce((best, value, k) => (Math.abs(value - wanted) < Math.abs(values[best] - wanted) ? k : best), 0);

	report.number = (value, digits = 4) => {
		if (value === null || !Number.isFinite(value)) return "–";
		if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)) return value.toExponential(2);
		return String(Number(value.toPrecision(digits)));
	};

	// Where the slider is, in words. Of a test with a list of stages it goes by time [s], of another by strain.
	const rowAt = (run, at) => report.nearest(run.stages.time, at);
	report.told = (run, at) => {
		if (!run.stages) return `${report.number(Math.abs(at) < SETTLING ? 0 : 100 * at, 3)} %`;
		const k = rowAt(run, at);
		return `${report.number(100 * run.stages.strain[k], 3)} % (${run.stages.stage[k]}, ${report.number(1e3 * (at - run.stages.time[0]), 4)} ms)`;
	};
	// The same on the axes of the curves: stage -> place there.
	report.marks = (run, at) =>
		run.stages ? { stages: 100 * run.stages.strain[rowAt(run, at)], time: 1e3 * (at - run.stages.time[0]) } : { shear: 100 * at };

	// An element with attributes and children; text is never read as markup.
	report.element = (name, attributes = {}, ...children) => {
		const made = document.createElement(name);
		for (const [key, value] of Object.entries(attributes)) {
			if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
			else if (value !== false && value !== null) made.setAttribute(key, value === true ? "" : value);
		}
		made.append(...children);
		return made;
	};
}
