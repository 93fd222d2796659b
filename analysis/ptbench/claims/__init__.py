"""The claims ledger: published sentences, what was predicted of them here, what was measured, and what follows."""
