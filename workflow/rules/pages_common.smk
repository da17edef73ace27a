"""What the rules of pages share: their templates and their names."""

from pathlib import Path

import fogreduce
from fogreduce.provenance.digest import data_digest, file_digest

TEMPLATES = {
    path.name: file_digest(path)
    for folder in ("templates", "uplot")
    for path in sorted((Path(fogreduce.__file__).parent / "pages" / folder).iterdir())
}


def campaign_pages():
    """The pages of the campaigns, if pages are asked for."""
    if not CONFIG.pages.enabled:
        return []
    return [
        f"{RESULTS}/{name}/index.html"
        for name, campaign in TABLE.campaigns.items()
        if campaign.runs
    ]
