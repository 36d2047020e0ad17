"""The paper's experiments, table by table, with its numbers."""
