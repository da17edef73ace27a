"""Metadata: what people write about campaigns, runs, calibrations and the workflow, validated."""
