"""What a machine answers to the seven questions of ptbench, from the file of `ptbench passport`."""
