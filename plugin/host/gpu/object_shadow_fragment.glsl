// Nothing but its depth.
void main() {}
