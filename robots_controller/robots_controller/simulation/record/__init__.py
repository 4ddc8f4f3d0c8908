"""What a simulated cell leaves: samples, events, and a bag with the topics of a live one."""
