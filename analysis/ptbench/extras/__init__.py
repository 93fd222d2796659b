"""What pages and results do without: commands of their own, which nothing outside of this folder imports."""
