"""The claims ledger: published sentences, each with a prediction for this renderer, measurements and a verdict."""
