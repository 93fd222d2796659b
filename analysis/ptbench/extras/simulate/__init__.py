"""What holds at a thousand GPUs, on paper: a render split over many, simulated from parts that were measured on few."""
