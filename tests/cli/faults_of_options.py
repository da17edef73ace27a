"""Faults of logs, of options, and of the place for the results."""

from string import Template

from fault_case import Case

ENCODER = '{"alpha_source": "encoder"}'
TEMPERATURES = "time_s,electronics_degC,sensor_degC\n"
ONE_OF_THESE = "expected time_s,electronics_degC,sensor_degC or time_s,sensor_degC or time_s,electronics_degC"


def _temperature(text):
    return lambda lab: lab.write_log("temperature", text)


def _table(text, *more):
    def spoil(lab):
        lab.write_log("table_log", text)
        return lab.reduce(*more)

    return spoil


def _parameters(text):
    return lambda lab: lab.reduce("--parameters", text)


def _file_for_out(lab):
    lab.out.write_text("kept")


def _out_below_a_file(lab):
    (lab.root / "file").write_text("kept")
    return [*lab.reduce()[:-1], str(lab.root / "file" / "out")]


def _file_for_run(lab):
    return ["reduce", str(lab.yaml), *lab.reduce()[2:]]


def _no_run(lab):
    return ["reduce", str(lab.run.with_name("r7")), *lab.reduce()[2:]]


def _diagnose(*options):
    """A diagnosis of the campaign; the options may name the laboratory's folders."""

    def arguments(lab):
        places = {"campaign": str(lab.campaign), "out": str(lab.out)}
        return ["diagnose", str(lab.campaign), *(Template(word).substitute(places) for word in options)]

    return arguments


LOGS = [
    Case(
        "a log that is not there",
        lambda lab: lab.write_run({"temperature": "t.csv"}),
        "$yaml: temperature: found t.csv, which is not there; expected a file in the run's own folder",
    ),
    Case(
        "temperatures: empty",
        _temperature(""),
        "$run/temperature.csv: found an empty file; " + ONE_OF_THESE,
    ),
    Case(
        "temperatures: header",
        _temperature("t,a,b\n0,20,20\n"),
        "$run/temperature.csv: line 1: found t,a,b; " + ONE_OF_THESE,
    ),
    Case(
        "temperatures: a line",
        _temperature(TEMPERATURES + "0,20,20\n1,20\n"),
        "$run/temperature.csv: line 3: found 1,20; expected 3 finite numbers",
    ),
    Case(
        "temperatures: NaN",
        _temperature(TEMPERATURES + "0,20,nan\n"),
        "$run/temperature.csv: line 2: found 0,20,nan; expected 3 finite numbers",
    ),
    Case(
        "temperatures: below absolute zero",
        _temperature(TEMPERATURES + "0,20,20\n1,20,-274\n"),
        "$run/temperature.csv: line 3: found sensor_degC -274.0; expected -273.15 to 500.0 degC",
    ),
    Case(
        "temperatures: time goes back",
        _temperature(TEMPERATURES + "0,20,20\n2,20,20\n1,20,20\n"),
        "$run/temperature.csv: line 4: found time_s 1.0 after 2.0; expected increasing times",
    ),
    Case(
        "encoder: header",
        _table("time_s,angle\n0,0\n"),
        "$run/table_log.csv: line 1: found time_s,angle; expected time_s,angle_deg",
    ),
    Case(
        "encoder: a line",
        _table("time_s,angle_deg\n0,0\n1,ten\n"),
        "$run/table_log.csv: line 3: found 1,ten; expected 2 finite numbers",
    ),
    Case(
        "encoder: no row, as alpha's source",
        _table("time_s,angle_deg\n", "--parameters", ENCODER),
        "$run/table_log.csv: line 2: found no rows; expected at least one",
    ),
    Case(
        "encoder as alpha's source without a log",
        _parameters(ENCODER),
        "$yaml: table_log: found no encoder log; expected one, since reduction.alpha_source is encoder",
    ),
]

OPTIONS = [
    Case(
        "parameters: not JSON",
        _parameters("{block_records: 5}"),
        "--parameters: found Expecting property name enclosed in double quotes: line 1 column 2 (char 1); "
        "expected a JSON object",
    ),
    Case("parameters: a list", _parameters("[1]"), "--parameters: found [1]; expected a JSON object"),
    Case(
        "parameters: unknown",
        _parameters('{"block_record": 5}'),
        "--parameters: block_record: found an unknown key (did you mean block_records?); expected one of "
        "block_records, storage, outliers, unstable, edge_guard_s, alpha_source, complete_records",
    ),
    Case(
        "parameters: out of range",
        _parameters('{"block_records": 0}'),
        "--parameters: block_records: found 0; expected a number, at least 256",
    ),
    Case(
        "parameters: NaN",
        _parameters('{"edge_guard_s": NaN}'),
        "--parameters: edge_guard_s: found nan; expected a finite number",
    ),
    Case(
        "parameters: compression without chunks",
        _parameters('{"storage": {"compression": "gzip"}}'),
        "--parameters: storage.chunk_records: found 0; "
        "expected a number of records, since compression needs chunks",
    ),
    Case(
        "no configuration",
        lambda lab: lab.reduce("--config", str(lab.root / "c.yaml")),
        "$root/c.yaml: found no such file; expected a YAML file",
    ),
    Case(
        "RUN that is not there", _no_run, "$campaign/runs/r7: found no such folder; expected a run's folder"
    ),
    Case("RUN that is a file", _file_for_run, "$yaml: found a file; expected a run's folder"),
    Case("results where a file is", _file_for_out, "$out: found a file; expected a folder"),
    Case(
        "results in the run's own folder",
        lambda lab: [*lab.reduce()[:-1], str(lab.run)],
        "--out: found $run, the folder of a run or a campaign itself; "
        "expected a folder of its own, apart from the raw data",
    ),
    Case(
        "a diagnosis in the campaign's own folder",
        _diagnose("--out", "$campaign"),
        "--out: found $campaign, the folder of a run or a campaign itself; "
        "expected a folder of its own, apart from the raw data",
    ),
    Case("no results", lambda lab: [*lab.reduce()[:-1], ""], "--out: found nothing; expected a value"),
    Case("no results, after =", lambda lab: lab.reduce("--out="), "--out: found nothing; expected a value"),
    Case("no run", lambda lab: ["check", ""], "an argument: found nothing; expected a value"),
    Case(
        "diagnose: no runs",
        _diagnose("--out", "$out", "--only-runs", ","),
        "--only-runs: found ,; expected names of runs: ID,...",
    ),
    Case(
        "simulate: no runs",
        lambda lab: ["simulate", str(lab.campaign), "--out", str(lab.out), "--only-runs", ",,"],
        "--only-runs: found ,,; expected names of runs: ID,...",
    ),
    Case(
        "a probability of nothing",
        _diagnose("--out", "$out", "--probability", "0.9"),
        "--probability: found no --detectable; expected both, or neither",
    ),
    Case(
        "detectable, and verified",
        _diagnose("--detectable", "--verify-next"),
        "--verify-next: found with --detectable; expected one of the two",
    ),
    Case(
        "a page where raw data are",
        lambda lab: ["page", "index", str(lab.campaign)],
        "DIR: found $campaign, the folder of a run or a campaign itself; "
        "expected a folder of its own, apart from the raw data",
    ),
    Case(
        "pages of campaigns that are not there",
        lambda lab: ["page", "index", str(lab.root), "--campaigns", "nope"],
        "--campaigns: found no folder nope; expected a folder",
    ),
    Case(
        "figures of a run that is not there",
        lambda lab: ["figures", "--out", str(lab.out), "--run", "nope"],
        "--run: found no folder nope; expected the run's folder",
    ),
    Case(
        "results below a file",
        _out_below_a_file,
        "$root/file: found a file; expected a folder",
    ),
]
