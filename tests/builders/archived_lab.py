"""A small campaign on its way from run.yaml to a bag, by the product's own commands."""

import contextlib
import hashlib
import json
import shutil
from pathlib import Path

import pytest
from small_unit import RECORD, run_yaml, succeed

from fogreduce.archive.software import source_files, source_folder
from fogreduce.archive.verify import verify
from fogreduce.errors import BadInput
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.provenance.code import digest_of, reduction_parts

CAMPAIGN = "c1"
RUNS = ("r1", "r2")


def two_rates(run_id):
    """Two rates, so that the tables have segments; each run turns the other way."""
    return run_yaml(run_id, [(10.0 if run_id == "r1" else -10.0, 40.0), (0.0, 30.0)])


class ArchivedLab:
    """Folders of the campaign, the calibration records, the results and the bags."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.campaigns = root / "campaigns"
        self.calibrations = root / "calibrations"
        self.results = root / "results"
        self.bag = root / "bags" / CAMPAIGN
        self.source = root / "source"
        (self.calibrations / "TETRA-01").mkdir(parents=True)
        (self.calibrations / "TETRA-01" / "2012a.yaml").write_text(dump_yaml(RECORD))
        plan = root / "plan" / CAMPAIGN
        for run_id in RUNS:
            folder = plan / "runs" / run_id
            folder.mkdir(parents=True)
            (folder / "run.yaml").write_text(dump_yaml(two_rates(run_id)))
        (plan / "campaign.yaml").write_text(dump_yaml({"title": "two runs, made up for tests"}))
        made = self.campaigns / CAMPAIGN
        succeed("simulate", plan, "--calibrations", self.calibrations, "--out", made)
        self._copy_source()
        with self.one_code():
            for run_id in RUNS:
                self.reduce(run_id)
        self.digest = self.archive(root / "bags")

    def _copy_source(self):
        here = source_folder(None)
        for name in source_files(here):
            (self.source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(here / name, self.source / name)

    @contextlib.contextmanager
    def one_code(self):
        """Manifests name the code that is archived, though someone may be at work on the source meanwhile."""
        digest = self.code()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("fogreduce.provenance.manifest.code_digest", lambda: digest)
            yield

    def code(self):
        """Hash of the code that is archived."""
        package = self.source / "fogreduce"
        sources = {path.relative_to(package).as_posix(): path for path in package.rglob("*.py")}
        return digest_of(sources, reduction_parts())

    def reduce(self, run_id, *more):
        """Reduce a run into the results, and take its checksums."""
        out = self.results / CAMPAIGN / run_id
        run = self.campaigns / CAMPAIGN / "runs" / run_id
        succeed("reduce", run, "--calibrations", self.calibrations, "--out", out, *more)
        succeed("checksums", out)
        return out

    def arguments(self, out):
        """Arguments that archive the results into a folder."""
        places = ["--campaigns", self.campaigns, "--calibrations", self.calibrations, "--source", self.source]
        return ["archive", self.results, *places, "--out", out]

    def archive(self, out):
        """Archive; the digest that is printed."""
        return succeed(*self.arguments(out)).split()[0]

    def copy(self, target):
        """A copy of the bag."""
        return Path(shutil.copytree(self.bag, target))


def seal(bag):
    """Make every checksum of a bag anew, as someone who covers up a change would; the new digest."""
    data = bag / "data"
    payload = sorted(path for path in data.rglob("*") if path.is_file() and not path.is_symlink())
    lines = sorted((path.relative_to(bag).as_posix(), sha256_of(path)) for path in payload)
    (bag / "manifest-sha256.txt").write_text("".join(f"{digest}  {path}\n" for path, digest in lines))
    info = (bag / "bag-info.txt").read_text().splitlines()
    oxum = f"Payload-Oxum: {sum(path.stat().st_size for path in payload)}.{len(payload)}"
    info = [oxum if line.startswith("Payload-Oxum") else line for line in info]
    (bag / "bag-info.txt").write_text("".join(f"{line}\n" for line in info))
    tags = ["bag-info.txt", "bagit.txt", "manifest-sha256.txt"]
    text = "".join(f"{sha256_of(bag / name)}  {name}\n" for name in tags)
    (bag / "tagmanifest-sha256.txt").write_text(text)
    return hashlib.sha256(text.encode()).hexdigest()


def describe(bag):
    """Make the crate's hashes anew too."""
    path = bag / "data" / "ro-crate-metadata.json"
    crate = json.loads(path.read_text())
    for entity in crate["@graph"]:
        file = bag / "data" / entity["@id"]
        if "sha256" in entity and file.is_file():
            entity["sha256"], entity["contentSize"] = sha256_of(file), str(file.stat().st_size)
    path.write_text(json.dumps(crate))


def sha256_of(path):
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def faults(bag, expect=None):
    """Faults of a bag, as text; none where it is sound."""
    try:
        return [str(fault) for fault in verify(bag, expect).faults]
    except BadInput as error:
        return [str(fault) for fault in error.faults]


def named(found, bag, path):
    """Whether a fault names the file."""
    return any(line.startswith(f"{bag / path}: ") for line in found)
