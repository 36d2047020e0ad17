"""The paper's experiments, table by table, beside its numbers."""
