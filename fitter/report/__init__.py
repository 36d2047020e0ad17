"""One page that shows what was learnt."""
