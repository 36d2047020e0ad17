"""The paper's tracker: moving average, double integration, from rest to rest."""
