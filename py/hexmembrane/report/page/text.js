// What is told in words: problems, verdict, configuration, versions, commands.
{
	const { content, element } = report;
	const SIGNS = { pass: "\u2713 pass", fail: "\u2717 fail", open: "\u25cb not judged" };
	const table = (headers, rows) =>
		element(
			"div",
			{ class: "scroll", tabindex: 0 },
			element(
				"table",
				{},
				element("thead", {}, element("tr", {}, ...headers.map((one) => element("th", { scope: "col" }, one)))),
				element("tbody", {}, ...rows),
			),
		);
	const state = (one, text = SIGNS[one.state]) => element("td", { class: `state ${one.state}` }, text);
	const row = (...cells) => element("tr", {}, ...cells.map((one) => (one instanceof Node ? one : element("td", {}, one))));

	report.problems = () => {
		const section = document.getElementById("problems");
		const found = content.runs.flatMap((run) => run.problems.map((one) => (content.runs.length > 1 ? `${run.name}: ${one}` : one)));
		section.hidden = found.length === 0;
		section.querySelector("ul").replaceChildren(...found.map((one) => element("li", {}, one)));
	};

	// All tests beside each other: a row a test, a column a check.
	report.overview = (section) => {
		if (content.runs.length < 2) return;
		const names = [...new Set(content.runs.flatMap((run) => run.verdict.map((one) => one.name)))];
		const cells = (run) =>
			names.map((name) => {
				const one = run.verdict.find((check) => check.name === name);
				return one ? state(one, `${SIGNS[one.state][0]} ${one.number}`) : element("td", {}, "–");
			});
		const peak = (run) => run.summary.find(([name]) => name === "peak of q")?.[1] ?? "–";
		section.append(
			table(
				["test", "peak of q", ...names],
				content.runs.map((run) => element("tr", {}, element("th", { scope: "row" }, run.name, element("div", { class: "label" }, run.label)), element("td", {}, peak(run)), ...cells(run))),
			),
			element("p", {}, "\u2713 pass, \u2717 fail, \u25cb not judged. The limits of the test picked above:"),
		);
	};

	report.verdict = (place, run) => {
		const facts = element(
			"dl",
			{ class: "facts" },
			...run.summary.map(([name, text]) => element("div", {}, element("dt", {}, name), element("dd", {}, text))),
		);
		const rows = run.verdict.map((one) =>
			element(
				"tr",
				{},
				element("th", { scope: "row" }, one.name),
				state(one),
				element("td", {}, one.number),
				element("td", {}, one.limit),
				element("td", { class: "why" }, one.why),
			),
		);
		place.replaceChildren(
			...(content.runs.length > 1 ? [element("h3", {}, run.label ? `${run.name}: ${run.label}` : run.name)] : []),
			...(run.summary.length ? [facts] : []),
			table(["check", "verdict", "number", "limit", "what it is"], rows),
			...run.apart.flatMap(({ name, rows: numbers }) => [
				element("h3", {}, `Against the laboratory's ${name}`),
				table(
					["number, up to the strain that both reach", "laboratory", "test"],
					numbers.map((cells) => row(...cells)),
				),
			]),
		);
	};

	report.origin = (place, run) => {
		const made = Object.entries(run.made),
			digests = Object.entries(run.digests);
		const commit = run.made.commit && run.made.commit !== "None" ? run.made.commit : null;
		const commands = [
			...(commit ? [`git checkout ${commit.replace("-dirty", "")}`] : []),
			`scripts/run ${quoted(`${run.folder}/config.yaml`)} --out AGAIN${run.made.threads ? ` --threads ${run.made.threads}` : ""}`,
			"scripts/report AGAIN",
		];
		place.replaceChildren(
			element("h3", {}, `${run.name}: ${run.title}`),
			element("p", {}, "Folder: ", element("code", {}, run.folder)),
			...(commit?.endsWith("-dirty") ? [element("p", { class: "problem" }, "The checkout that made it was changed after its commit.")] : []),
			element("h3", {}, "To make it again"),
			element("pre", { tabindex: 0 }, commands.join("\n")),
			...(made.length
				? [
						element("h3", {}, "Made by"),
						table(
							["what", "value"],
							made.map(([name, value]) => row(name, value)),
						),
					]
				: []),
			...(digests.length
				? [
						element("h3", {}, "Digests"),
						table(
							["file", "SHA-256"],
							digests.map(([name, value]) => row(name, element("td", {}, element("code", {}, value)))),
						),
					]
				: []),
			element("h3", {}, "Configuration"),
			element("pre", { tabindex: 0 }, run.configuration || "There is none."),
		);
	};

	// A path as a shell takes it.
	const quoted = (path) => (/^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`);

	// Keys in which the tests differ.
	report.differences = (section) => {
		if (!content.differences.length) return;
		section.append(
			element("h3", {}, "Keys in which the tests differ"),
			table(
				["key", ...content.runs.map((run) => run.name)],
				content.differences.map(({ key, values }) => row(element("td", {}, element("code", {}, key)), ...values)),
			),
		);
	};
}
