"""The pipeline process: from bytes to motion that is handed on."""
