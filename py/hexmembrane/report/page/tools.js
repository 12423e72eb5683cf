// What is drawn of the specimen in space, and how: lists, boxes, sliders and buttons above it.
{
	const { element } = report;

	// options: what is wanted, by name, changed here. scene: {fill, look}, called when something has changed and to look from a direction.
	report.tools = (data, options, scene) => {
		const selects = {},
			aside = { grains: "none", boundary: "none" };
		const change = (name, value) => {
			options[name] = value;
			// grains hide force chains, and colours behind them confuse: both go when these come, and come back
			if (name === "chains")
				for (const [other, kept] of Object.entries(aside)) {
					if (value || options[other] === "none") [options[other], aside[other]] = [value ? "none" : kept, options[other]];
					if (selects[other]) selects[other].value = options[other];
				}
			scene.fill();
		};
		const select = (label, name, choices) => {
			selects[name] = element(
				"select",
				{ onchange: (event) => change(name, event.target.value) },
				...choices.map(([value, text]) => element("option", { value, selected: value === options[name] }, text)),
			);
			return element("label", {}, label, selects[name]);
		};
		const listed = (quantities) => quantities.map((one) => [one.name, one.label]);
		const slider = (label, name, min, max) =>
			element(
				"label",
				{},
				label,
				element("input", { type: "range", min, max, value: options[name], oninput: (event) => change(name, Number(event.target.value)) }),
			);
		const box = (label, name) =>
			element(
				"label",
				{},
				element("input", { type: "checkbox", checked: options[name], onchange: (event) => change(name, event.target.checked) }),
				label,
			);
		const made = element(
			"div",
			{ class: "tools" },
			select("grains coloured by ", "grains", [...listed(data.grains.quantities), ["none", "not shown"]]),
		);
		if (data.boundary)
			made.append(
				select("boundary ", "sheet", [
					["back", "its back half"],
					["whole", "whole"],
					["glass", "see-through"],
					["none", "not shown"],
				]),
				select("coloured by ", "boundary", [...listed(data.boundary.quantities), ["none", "nothing"]]),
			);
		made.append(box("upright cut", "cut"), slider("at ", "depth", -100, 100), slider("turned ", "azimuth", 0, 360));
		made.append(box("level cut", "top"), slider("at height [%] ", "level", 0, 100));
		if (data.chains) made.append(box("force chains", "chains"), slider("strongest contacts [%] ", "share", 1, 50));
		if (data.planes.length) made.append(box("planes of bands", "bands"));
		for (const [name, direction] of [
			["front", [0, -1, 0.15]],
			["side", [1, 0, 0.15]],
			["top", [0, -0.01, 1]],
		])
			made.append(element("button", { type: "button", onclick: () => scene.look(direction) }, name));
		return made;
	};
}
